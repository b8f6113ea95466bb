#pragma once

#include <ros/ros.h>
#include <tf2_msgs/TFMessage.h>
#include <tf2_ros/buffer.h>

#include <functional>
#include <map>
#include <string>

#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/stamp_check.h"

namespace mrhi {

/// Where trackers stand, by /tf and /tf_static, read by the callbacks' own thread. tf2's listener takes what
/// comes: a stamp beyond a duration's range ends the node there, and one far ahead makes all that follow too
/// old.
class TrackerTransforms {
 public:
  /// Is told why a transform is left out, and which.
  using Refused = std::function<void(const char* reason, const std::string& what)>;
  static constexpr const char* kReason = "unusable transform";

  TrackerTransforms(ros::NodeHandle node, Refused refused);

  /// Pose of a frame in another: at the stamp, else the latest. Throws tf2::TransformException.
  Pose pose(const std::string& fixed, const std::string& frame, Nanoseconds stamp) const;
  /// What moves is forgotten: it would be refused as older than what is here.
  void clear();

 private:
  using Arrival = ros::MessageEvent<const tf2_msgs::TFMessage>;
  /// When transforms of a frame came, and what was the last to be believed.
  struct Stream {
    StampCheck check;
    Nanoseconds arrival = 0;
  };
  void take(const Arrival& arrival);
  bool believed(const geometry_msgs::TransformStamped& transform);

  Refused refused_;
  std::map<std::string, Stream> streams_;  // by the child frame
  tf2_ros::Buffer buffer_;
  ros::Subscriber moving_, fixed_;
};

}  // namespace mrhi
