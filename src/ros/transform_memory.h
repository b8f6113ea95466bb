#pragma once

#include <geometry_msgs/TransformStamped.h>
#include <tf2/buffer_core.h>
#include <tf2/exceptions.h>

#include <map>
#include <string>

#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/stamp_check.h"

namespace mrhi {

/// Where trackers stand, by the transforms of /tf and /tf_static in the order in which they came: live, and
/// from a bag. A stamp beyond a duration's range would end the node in tf2's own listener, and one far ahead
/// makes all that follow too old.
class TransformMemory {
 public:
  /// What never moves.
  void set_fixed(const geometry_msgs::TransformStamped& transform);
  /// What may move, as it came at `now`. Returns why it is left out; empty: it is not.
  std::string set(const geometry_msgs::TransformStamped& transform, Nanoseconds now);

  /// Whether a chain of transforms leads from one frame to the other.
  bool connects(const std::string& fixed, const std::string& frame) const;
  /// Pose of a frame in another: at the stamp, else the latest. Throws tf2::TransformException.
  Pose pose(const std::string& fixed, const std::string& frame, Nanoseconds stamp) const;
  /// What moves is forgotten: it would be refused as older than what is here.
  void clear() { buffer_.clear(); }

 private:
  /// When transforms of a frame came, and what was the last to be believed.
  struct Stream {
    StampCheck check;
    Nanoseconds arrival = 0;
  };
  std::map<std::string, Stream> streams_;  // by the child frame
  tf2::BufferCore buffer_;
};

}  // namespace mrhi
