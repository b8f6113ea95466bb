#include "stamp_clock.h"

#include <algorithm>
#include <utility>

#include "mr_hand_interaction/ros/hand_frame_conversion.h"

namespace mrhi {
namespace {

constexpr Nanoseconds kLeap =
    1'000'000'000;  // farther than four times what passed before, too: a clock may be fast

}  // namespace

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

bool ClockLeaps::look(Nanoseconds now) {
  const Nanoseconds before = std::exchange(looked_, now), stride = std::exchange(stride_, now - before);
  return before != 0 && stride_ > kLeap && stride_ / 4 > stride;
}

}  // namespace mrhi
