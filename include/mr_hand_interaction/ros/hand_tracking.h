#pragma once

#include <ros/node_handle.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "mr_hand_interaction/tracking/hand.h"

namespace mrhi {

/// Turns what hand trackers publish into hand_frame, placed in the fixed frame by tf2. A hand of joints alone
/// (PoseArray, PointCloud) is of the side that its topic names, else its frame, else of ~side. Parameters:
/// ~fixed_frame (world); ~side (right), of hands/pose_array and hands/point_cloud; ~order of joints (empty:
/// recognised); ~scale, metres per unit of the tracker (1). Throws an exception in one line for a bad one.
class HandTracking {
 public:
  HandTracking(const ros::NodeHandle& node, const ros::NodeHandle& private_node);
  ~HandTracking();

  /// Who is in the same process gets each frame at once, before it is published, with the frame that it is
  /// placed in and when its message arrived. Its numbers are those of the message.
  using Sink = std::function<void(HandFrame, const std::string& frame_id, const ros::Time& arrival)>;
  void pass_to(Sink sink);
  /// Frames of trackers that were sent and have not arrived, so far.
  std::uint64_t lost() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mrhi
