#include <ros/ros.h>

#include <exception>

#include "../ros/node.h"
#include "mr_hand_interaction/ros/interaction_server.h"

namespace {

constexpr const char* kUsage =
    R"(usage: rosrun mr_hand_interaction interaction_node [_PARAMETER:=VALUE]... [TOPIC:=OTHER]...

Takes hand_frame, and publishes what the hands do to the objects: rendered_hands, tracked_hands, objects, contacts,
interaction_events, haptics, markers, /tf, simulation_input, /diagnostics. Services: ~reset, ~pause, ~spawn, ~delete, ~set.

  ~scene              NAME|FILE; default cube
  ~fixed_frame        default world
  ~haptics/rate       frame or step; default frame
  ~place_by_mouse     default false
  ~standard_outputs   also as PoseStamped, WrenchStamped, String and PoseArray; default false
  ~object_twist/NAME  [vx, vy, vz, wx, wy, wz] at the start
and all that config/default.yaml lists, such as _contact_model:=seed.
)";

}  // namespace

int main(int argc, char** argv) {
  if (const auto status = mrhi::status_of_arguments(argc, argv, kUsage)) return *status;
  ros::init(argc, argv, "interaction_node");
  mrhi::end_in_order();
  const ros::NodeHandle private_node("~");  // outlives what may throw: without a node nothing is logged
  const mrhi::MasterWatch master;
  try {
    ros::NodeHandle node;
    mrhi::InteractionServer server(node, private_node, mrhi::read_server_parameters(private_node));
    server.subscribe(node);
    ros::spin();
  } catch (const std::exception& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
  return 0;
}
