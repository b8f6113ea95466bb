#pragma once

#include <rosbag/bag.h>
#include <tf2/buffer_core.h>

#include <map>
#include <optional>
#include <string>

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// Where trackers stand in world: everywhere the same, if that was given; else as a bag's /tf_static says,
/// else at the default mount.
class DeviceFrames {
 public:
  DeviceFrames(const rosbag::Bag& bag, const std::optional<Pose>& device_in_world);

  const Pose& pose(const std::string& frame_id);

 private:
  void read_static_transforms(const rosbag::Bag& bag);

  std::optional<Pose> given_;
  tf2::BufferCore transforms_;
  std::map<std::string, Pose> known_;
};

}  // namespace mrhi
