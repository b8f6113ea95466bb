#include "transform_memory.h"

#include <optional>

#include "../text/text.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"

namespace mrhi {
namespace {

constexpr std::size_t kMostFrames = 10'000;

std::string without_slash(const std::string& frame) {
  return frame.substr(frame.compare(0, 1, "/") == 0 ? 1 : 0);
}

std::string named(const geometry_msgs::TransformStamped& transform) {
  return "from '" + text::one_line(transform.header.frame_id, 64) + "' to '" +
         text::one_line(transform.child_frame_id, 64) + "'";
}

geometry_msgs::TransformStamped without_slashes(geometry_msgs::TransformStamped transform) {
  transform.header.frame_id = without_slash(transform.header.frame_id);
  transform.child_frame_id = without_slash(transform.child_frame_id);
  return transform;
}

}  // namespace

void TransformMemory::set_fixed(const geometry_msgs::TransformStamped& transform) {
  buffer_.setTransform(without_slashes(transform), "fixed", true);
}

/// Out of order is no fault of a transform, which the buffer sorts in. A clock that stands or runs off tells
/// nothing: a frame's stream has the time of its own stamps, and of what has passed since the last of them.
std::string TransformMemory::set(const geometry_msgs::TransformStamped& transform, Nanoseconds now) {
  if (streams_.size() >= kMostFrames && streams_.count(transform.child_frame_id) == 0)
    return named(transform) + ": there are " + std::to_string(kMostFrames) + " frames already";
  const Nanoseconds stamp = from_ros_time(transform.header.stamp);
  Stream& stream = streams_[transform.child_frame_id];
  std::optional<Nanoseconds> expected;
  if (stream.check.started && now > stream.arrival) expected = stream.check.last + (now - stream.arrival);
  const StampVerdict verdict = stream.check.check(stamp, stream.check.last, expected);
  const bool believed = verdict == StampVerdict::follows || verdict == StampVerdict::restart;
  if (verdict == StampVerdict::restart) clear();
  if (believed) stream.arrival = now;
  if (!believed && verdict != StampVerdict::late)
    return named(transform) + ": stamp " + std::to_string(stamp / 1'000'000'000) +
           " s is far from its others'";
  buffer_.setTransform(without_slashes(transform), "moving");
  return "";
}

bool TransformMemory::connects(const std::string& fixed, const std::string& frame) const {
  const std::string source = without_slash(frame);
  return source == fixed || (!source.empty() && buffer_.canTransform(fixed, source, ros::Time(0)));
}

Pose TransformMemory::pose(const std::string& fixed, const std::string& frame, Nanoseconds stamp) const {
  const std::string source = without_slash(frame);
  try {
    return from_message(buffer_.lookupTransform(fixed, source, to_ros_time(stamp)).transform);
  } catch (const tf2::ExtrapolationException&) {
    return from_message(buffer_.lookupTransform(fixed, source, ros::Time(0)).transform);
  }
}

}  // namespace mrhi
