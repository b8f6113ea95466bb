#include <ros/ros.h>

#include "../ros/node.h"
#include "../ros/training_server.h"

namespace {

constexpr const char* kUsage =
    R"(usage: rosrun mr_hand_interaction training_node _participant:=NAME _folder:=FOLDER _group:=NAME _handedness:=SIDE
              _condition:=NAME [_PARAMETER:=VALUE]...

Leads a participant through a task beside a running interaction_node, and logs it; training.launch starts it with
all that it needs. Publishes training/status and training/markers. Services: ~next, ~pause, ~skip, ~repeat.

  ~participant, ~folder        who takes part, and the session's folder; these five must be given
  ~group, ~handedness, ~condition
                               such as beginner; right or left; what they work with, such as implicit
  ~task                        NAME|FILE; default pick_and_place
  ~auto_next                   break between trials, at most 3600 s; below 0: each waits for ~next; default 3
  ~seed, ~number, ~session, ~simulated, ~simulation, ~auto_start, ~operator
                               see docs/training.md
)";

}  // namespace

int main(int argc, char** argv) {
  const auto body = [](const ros::NodeHandle& node, const ros::NodeHandle& private_node) {
    const mrhi::TrainingServer server(node, private_node, mrhi::read_training_parameters(private_node));
    ros::spin();
  };
  return mrhi::run_node(argc, argv, "training_node", kUsage, body);
}
