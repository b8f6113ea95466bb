#include "tracker_transforms.h"

#include "mr_hand_interaction/ros/hand_frame_conversion.h"

namespace mrhi {
namespace {

constexpr std::uint32_t kQueue = 100;

}  // namespace

TrackerTransforms::TrackerTransforms(ros::NodeHandle node, Refused refused) : refused_(std::move(refused)) {
  moving_ = node.subscribe<tf2_msgs::TFMessage>(
      "/tf", kQueue,
      boost::function<void(const Arrival&)>([this](const Arrival& arrival) { take(arrival); }));
  const auto take_fixed = [this](const Arrival& arrival) {
    for (const auto& transform : arrival.getConstMessage()->transforms) memory_.set_fixed(transform);
  };
  fixed_ = node.subscribe<tf2_msgs::TFMessage>("/tf_static", kQueue,
                                               boost::function<void(const Arrival&)>(take_fixed));
}

/// What this node itself gives are objects, which carry no tracker.
void TrackerTransforms::take(const Arrival& arrival) {
  if (arrival.getPublisherName() == ros::this_node::getName()) return;
  for (const auto& transform : arrival.getConstMessage()->transforms) {
    const std::string why = memory_.set(transform, from_ros_time(ros::Time::now()));
    if (!why.empty()) refused_(kReason, why);
  }
}

}  // namespace mrhi
