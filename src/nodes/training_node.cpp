#include <ros/ros.h>

#include <exception>

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
  ~seed, ~number, ~session, ~simulated, ~simulation, ~auto_start
                               see docs/training.md
)";

}  // namespace

int main(int argc, char** argv) {
  if (const auto status = mrhi::status_of_arguments(argc, argv, kUsage)) return *status;
  ros::init(argc, argv, "training_node");
  mrhi::end_in_order();
  const ros::NodeHandle private_node("~");  // outlives what may throw: without a node nothing is logged
  const mrhi::MasterWatch master;
  try {
    const mrhi::TrainingServer server(ros::NodeHandle(), private_node,
                                      mrhi::read_training_parameters(private_node));
    ros::spin();
  } catch (const std::exception& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
  return 0;
}
