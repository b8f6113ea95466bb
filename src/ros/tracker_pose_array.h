#pragma once

#include <geometry_msgs/PoseArray.h>

#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "tracked_points.h"

namespace mrhi {

/// Orientations are not used.
struct PoseArrayTracker {
  using Message = geometry_msgs::PoseArray;
  static constexpr const char* kTopic = "pose_array";

  static TrackedPoints read(const Message& message) {
    TrackedPoints tracked{message.header, {}};
    for (const geometry_msgs::Pose& pose : message.poses)
      tracked.points.push_back(from_message(pose.position));
    return tracked;
  }
};

}  // namespace mrhi
