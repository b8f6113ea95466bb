#include <ros/ros.h>

#include <exception>

#include "mr_hand_interaction/ros/end_in_order.h"
#include "mr_hand_interaction/ros/master_watch.h"
#include "mr_hand_interaction/ros/operator_publisher.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "simulated_operator_node");
  mrhi::end_in_order();
  const ros::NodeHandle node, parameters("~");  // outlive what may throw: without a node nothing is logged
  const mrhi::MasterWatch master;
  try {
    const mrhi::OperatorPublisher publisher(node, parameters);
    ros::spin();
  } catch (const std::exception& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
  return 0;
}
