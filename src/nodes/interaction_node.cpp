#include <ros/ros.h>

#include <exception>

#include "mr_hand_interaction/ros/end_in_order.h"
#include "mr_hand_interaction/ros/interaction_server.h"
#include "mr_hand_interaction/ros/master_watch.h"

int main(int argc, char** argv) {
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
