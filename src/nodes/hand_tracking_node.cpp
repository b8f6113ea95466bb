#include <ros/ros.h>

#include <exception>

#include "mr_hand_interaction/ros/end_in_order.h"
#include "mr_hand_interaction/ros/hand_tracking.h"
#include "mr_hand_interaction/ros/master_watch.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "hand_tracking_node");
  mrhi::end_in_order();
  const ros::NodeHandle private_node("~");  // outlives what may throw: without a node nothing is logged
  const mrhi::MasterWatch master;
  try {
    const mrhi::HandTracking tracking(ros::NodeHandle(), private_node);
    ros::spin();
  } catch (const std::exception& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
  return 0;
}
