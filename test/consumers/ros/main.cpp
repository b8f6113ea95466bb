#include <ros/ros.h>

#include "mr_hand_interaction/ros/interaction_server.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "ros_consumer");
  if (argc < 2) return 0;  // built and loaded
  ros::NodeHandle node, private_node("~");
  mrhi::InteractionServer server(node, private_node, mrhi::read_server_parameters(private_node));
  server.subscribe(node);
  ros::spin();
  return 0;
}
