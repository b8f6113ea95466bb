#pragma once

#include <ros/node_handle.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "mr_hand_interaction/tracking/hand.h"

namespace mrhi {

/// Converts messages of hand trackers to hand_frame, transformed to the fixed frame by tf2. The side of a
/// hand of joints alone (PoseArray, PointCloud) is that in its topic's name, else in its frame's, else ~side.
/// Parameters: ~fixed_frame (world); ~side (right), of hands/pose_array and hands/point_cloud; ~order of
/// joints (empty: detected); ~scale, metres per unit of the tracker (1). Throws an exception with one line
/// for an invalid one.
class HandTracking {
 public:
  HandTracking(const ros::NodeHandle& node, const ros::NodeHandle& private_node);
  ~HandTracking();

  /// Callback in the same process, called for each frame before it is published, with the fixed frame and the
  /// arrival time of its message. Values are those of the published message.
  using Sink = std::function<void(HandFrame, const std::string& frame_id, const ros::Time& arrival)>;
  void pass_to(Sink sink);
  /// Number of frames that trackers have sent and that have not arrived.
  std::uint64_t lost() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mrhi
