#pragma once

#include <geometry_msgs/PoseArray.h>

#include "bounded_message.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "tracked_points.h"

namespace mrhi {

/// Orientations are not used.
struct PoseArrayTracker {
  static constexpr const char* kType = "geometry_msgs/PoseArray";
  static std::vector<std::string> topics() { return hands_topics("pose_array"); }
  static std::vector<std::string> md5s() { return {ros::message_traits::md5sum<geometry_msgs::PoseArray>()}; }

  template <class Message>
  static TrackedPoints read(const Message& message) {
    TrackedPoints tracked{header_of(message.header), {}, {}};
    for (const auto& pose : message.poses)
      tracked.points.emplace_back(pose.position.x, pose.position.y, pose.position.z);
    return tracked;
  }
  static TrackerMessage read(const std::string& /*md5*/, std::vector<std::uint8_t>& bytes) {
    return read(deserialised<geometry_msgs::PoseArray_<Bounded>>(kType, bytes));
  }
};

}  // namespace mrhi
