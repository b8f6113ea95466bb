#include <ros/ros.h>

#include <cstdint>
#include <string>
#include <utility>

#include "../ros/network_thread.h"
#include "../ros/node.h"
#include "mr_hand_interaction/ros/hand_tracking.h"
#include "mr_hand_interaction/ros/interaction_server.h"

constexpr const char* kUsage =
    R"(usage: rosrun mr_hand_interaction hand_interaction_node [_PARAMETER:=VALUE]... [TOPIC:=OTHER]...

Runs hand_tracking_node and interaction_node in one process; the launch files start it. It has the topics, services and
parameters of both. The parameters of hand_tracking_node are in ~hand_tracking. See the --help of both.
)";

/// Both nodes share one thread: a call passes each frame on.
int main(int argc, char** argv) {
  mrhi::NetworkThreadQueue queue;  // before the first node handle
  const auto body = [&queue](const ros::NodeHandle& node, const ros::NodeHandle& private_node) {
    const ros::NodeHandle here = queue.handle(node), private_here = queue.handle(private_node);
    mrhi::InteractionServer server(here, private_here, mrhi::read_server_parameters(private_node));
    mrhi::HandTracking tracking(here, ros::NodeHandle(private_here, "hand_tracking"));
    std::uint64_t lost = 0;  // number already reported to the server
    tracking.pass_to([&](mrhi::HandFrame frame, const std::string& frame_id, const ros::Time& arrival) {
      server.note_lost(tracking.lost() - std::exchange(lost, tracking.lost()));
      server.take(std::move(frame), frame_id, arrival);
    });
    queue.spin();
  };
  return mrhi::run_node(argc, argv, "interaction_node", kUsage, body);
}
