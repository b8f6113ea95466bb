#include "device_frames.h"

#include <rosbag/view.h>
#include <tf2_msgs/TFMessage.h>

#include <vector>

#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/synthetic/scripted_motion.h"

namespace mrhi {
namespace {

const char* const kWorld = "world";

std::string without_slash(const std::string& frame_id) {
  return frame_id.compare(0, 1, "/") == 0 ? frame_id.substr(1) : frame_id;
}

}  // namespace

DeviceFrames::DeviceFrames(const rosbag::Bag& bag, const std::optional<Pose>& device_in_world)
    : given_(device_in_world) {
  if (!given_) read_static_transforms(bag);
}

void DeviceFrames::read_static_transforms(const rosbag::Bag& bag) {
  rosbag::View view(bag, rosbag::TopicQuery(std::vector<std::string>{"/tf_static", "tf_static"}));
  for (const rosbag::MessageInstance& message : view) {
    const auto transforms = message.instantiate<tf2_msgs::TFMessage>();
    if (!transforms) continue;
    for (geometry_msgs::TransformStamped transform : transforms->transforms) {
      transform.header.frame_id = without_slash(transform.header.frame_id);
      transform.child_frame_id = without_slash(transform.child_frame_id);
      transforms_.setTransform(transform, "bag", true);
    }
  }
}

const Pose& DeviceFrames::pose(const std::string& frame_id) {
  if (given_) return *given_;
  const auto found = known_.find(frame_id);
  if (found != known_.end()) return found->second;
  const std::string frame = without_slash(frame_id);
  const bool connected = !frame.empty() && transforms_.canTransform(kWorld, frame, ros::Time(0));
  const Pose pose = connected
                        ? from_message(transforms_.lookupTransform(kWorld, frame, ros::Time(0)).transform)
                        : default_device_mount();
  return known_.emplace(frame_id, pose).first->second;
}

}  // namespace mrhi
