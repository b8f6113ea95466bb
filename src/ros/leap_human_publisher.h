#pragma once

#include <ros/ros.h>
#include <topic_tools/shape_shifter.h>

#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {

/// Publishes hands on /leap_motion/leap_device as the Leap driver would.
class LeapHumanPublisher {
 public:
  /// `rate`: frames per second, as the messages have it.
  LeapHumanPublisher(ros::NodeHandle& node, double rate);

  /// In the device's frame; the stamp is ROS time.
  void publish(const JointsFrame& frame);
  bool has_listener() const { return publisher_.getNumSubscribers() > 0; }

 private:
  float rate_;
  ros::Publisher publisher_;
  topic_tools::ShapeShifter message_;
  std::uint32_t sequence_ = 0;
};

}  // namespace mrhi
