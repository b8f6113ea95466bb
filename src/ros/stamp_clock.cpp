#include "stamp_clock.h"

#include <algorithm>

#include "mr_hand_interaction/ros/hand_frame_conversion.h"

namespace mrhi {

void StampClock::take(Nanoseconds stamp, const ros::Time& now) {
  started_ = true;
  last_stamp_ = stamp;
  arrival_ = now;
}

Nanoseconds StampClock::stamp(const ros::Time& now) const {
  if (!started_) return from_ros_time(now);
  return last_stamp_ + std::max<Nanoseconds>(0, from_ros_time(now) - from_ros_time(arrival_));
}

void StampClock::pause(const ros::Time& now) {
  if (!paused_) pause_begin_ = stamp(now);
  paused_ = true;
}

void StampClock::resume(const ros::Time& now) {
  if (paused_) pauses_ += std::max<Nanoseconds>(0, stamp(now) - pause_begin_);
  paused_ = false;
}

}  // namespace mrhi
