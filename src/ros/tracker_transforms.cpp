#include "tracker_transforms.h"

#include <optional>

#include "../text/text.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"

namespace mrhi {
namespace {

constexpr std::uint32_t kQueue = 100;
constexpr std::size_t kMostFrames = 10'000;

std::string named(const geometry_msgs::TransformStamped& transform) {
  return "from '" + text::one_line(transform.header.frame_id, 64) + "' to '" +
         text::one_line(transform.child_frame_id, 64) + "'";
}

}  // namespace

TrackerTransforms::TrackerTransforms(ros::NodeHandle node, Refused refused) : refused_(std::move(refused)) {
  moving_ = node.subscribe<tf2_msgs::TFMessage>(
      "/tf", kQueue,
      boost::function<void(const Arrival&)>([this](const Arrival& arrival) { take(arrival); }));
  const auto take_fixed = [this](const Arrival& arrival) {
    for (const auto& transform : arrival.getConstMessage()->transforms)
      buffer_.setTransform(transform, arrival.getPublisherName(), true);
  };
  fixed_ = node.subscribe<tf2_msgs::TFMessage>("/tf_static", kQueue,
                                               boost::function<void(const Arrival&)>(take_fixed));
}

/// What this node itself gives are objects, which carry no tracker.
void TrackerTransforms::take(const Arrival& arrival) {
  const std::string& publisher = arrival.getPublisherName();
  if (publisher == ros::this_node::getName()) return;
  for (const auto& transform : arrival.getConstMessage()->transforms)
    if (believed(transform)) buffer_.setTransform(transform, publisher);
}

/// Out of order is no fault of a transform, which the buffer sorts in. A clock that stands or runs off tells
/// nothing: a frame's stream has the time of its own stamps, and of what has passed since the last of them.
bool TrackerTransforms::believed(const geometry_msgs::TransformStamped& transform) {
  const Nanoseconds stamp = from_ros_time(transform.header.stamp), now = from_ros_time(ros::Time::now());
  if (streams_.size() >= kMostFrames && streams_.count(transform.child_frame_id) == 0) {
    refused_(kReason, named(transform) + ": there are " + std::to_string(kMostFrames) + " frames already");
    return false;
  }
  Stream& stream = streams_[transform.child_frame_id];
  std::optional<Nanoseconds> expected;
  if (stream.check.started && now > stream.arrival) expected = stream.check.last + (now - stream.arrival);
  switch (stream.check.check(stamp, stream.check.last, expected)) {
    case StampVerdict::follows:
      stream.arrival = now;
      return true;
    case StampVerdict::restart:
      clear();
      stream.arrival = now;
      return true;
    case StampVerdict::late:
      return true;
    case StampVerdict::ahead:
    case StampVerdict::behind:
    case StampVerdict::no_time:
      break;
  }
  refused_(kReason, named(transform) + ": stamp " + std::to_string(stamp / 1'000'000'000) +
                        " s is far from its others'");
  return false;
}

Pose TrackerTransforms::pose(const std::string& fixed, const std::string& frame, Nanoseconds stamp) const {
  const std::string source = frame.substr(frame.compare(0, 1, "/") == 0 ? 1 : 0);
  try {
    return from_message(buffer_.lookupTransform(fixed, source, to_ros_time(stamp)).transform);
  } catch (const tf2::ExtrapolationException&) {
    return from_message(buffer_.lookupTransform(fixed, source, ros::Time(0)).transform);
  }
}

void TrackerTransforms::clear() {
  buffer_.clear();
}

}  // namespace mrhi
