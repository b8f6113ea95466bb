#include <ros/ros.h>

#include "../ros/network_thread.h"
#include "../ros/node.h"
#include "mr_hand_interaction/ros/interaction_server.h"

constexpr const char* kUsage =
    R"(usage: rosrun mr_hand_interaction interaction_node [_PARAMETER:=VALUE]... [TOPIC:=OTHER]...

Subscribes to hand_frame, simulates the contact of the hands with the objects, and publishes rendered_view,
rendered_hands, tracked_hands, objects, contacts, interaction_events, haptics, haptics/joints, joint_states, scene,
markers, /tf, simulation_input, /diagnostics. docs/messages.md describes them.
Services: ~set, ~spawn, ~spawn_urdf, ~save, ~delete, ~reset, ~pause, ~restrain; ~tune (dynamic_reconfigure).

  ~scene              NAME|FILE; default cube
  ~fixed_frame        default world
  ~haptics/rate       frame or step; default frame
  ~place_by_mouse     default false
  ~standard_outputs   also publishes PoseStamped, WrenchStamped, String and PoseArray; default false
  ~object_twist/NAME  [vx, vy, vz, wx, wy, wz] at the start
and all parameters of config/default.yaml, such as _contact_model:=seed.
)";

int main(int argc, char** argv) {
  mrhi::NetworkThreadQueue queue;  // before the first node handle
  const auto body = [&queue](const ros::NodeHandle& node, const ros::NodeHandle& private_node) {
    ros::NodeHandle here = queue.handle(node);
    mrhi::InteractionServer server(here, queue.handle(private_node),
                                   mrhi::read_server_parameters(private_node));
    server.subscribe(here);
    queue.spin();
  };
  return mrhi::run_node(argc, argv, "interaction_node", kUsage, body);
}
