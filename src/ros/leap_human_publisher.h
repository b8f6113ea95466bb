#pragma once

#include <ros/ros.h>
#include <topic_tools/shape_shifter.h>

#include <cstdint>
#include <string>

#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {

/// Writes a frame as leap_motion/Human in its newest version. The frame is in the device's frame and has at
/// most one hand of each side; throws std::invalid_argument for two. Missing parts of a hand are zero or
/// absent from its list, as in the driver's messages. So are bone orientations: Leap's (z towards the wrist,
/// y out of the back), conjugated. `rate`: frames per second.
void write_leap(const JointsFrame& frame, const std::string& frame_id, std::uint32_t sequence, float rate,
                topic_tools::ShapeShifter& message);

/// Publishes hands on /leap_motion/leap_device as the Leap driver would.
class LeapHumanPublisher {
 public:
  LeapHumanPublisher(const ros::NodeHandle& node, double rate)
      : node_(node), rate_(static_cast<float>(rate)) {
    write_leap({}, "", 0, rate_, message_);  // advertised with its type
    publisher_ = message_.advertise(node_, "/leap_motion/leap_device", 10);
  }

  /// The frame is in the device's frame; its stamp is ROS time.
  void publish(const JointsFrame& frame) {
    write_leap(frame, "leap_hands", sequence_++, rate_, message_);
    publisher_.publish(message_);
  }
  bool has_listener() const { return publisher_.getNumSubscribers() > 0; }

 private:
  ros::NodeHandle node_;
  float rate_;
  topic_tools::ShapeShifter message_;
  ros::Publisher publisher_;
  std::uint32_t sequence_ = 0;
};

}  // namespace mrhi
