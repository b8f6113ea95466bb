#pragma once

#include <ros/ros.h>
#include <tf2_msgs/TFMessage.h>

#include <functional>
#include <string>

#include "transform_memory.h"

namespace mrhi {

/// A TransformMemory of /tf and /tf_static, read by the callbacks' own thread.
class TrackerTransforms {
 public:
  /// Is told why a transform is left out, and which.
  using Refused = std::function<void(const char* reason, const std::string& what)>;
  static constexpr const char* kReason = "unusable transform";

  TrackerTransforms(ros::NodeHandle node, Refused refused);

  /// As TransformMemory.
  Pose pose(const std::string& fixed, const std::string& frame, Nanoseconds stamp) const {
    return memory_.pose(fixed, frame, stamp);
  }
  void clear() { memory_.clear(); }

 private:
  using Arrival = ros::MessageEvent<const tf2_msgs::TFMessage>;
  void take(const Arrival& arrival);

  Refused refused_;
  TransformMemory memory_;
  ros::Subscriber moving_, fixed_;
};

}  // namespace mrhi
