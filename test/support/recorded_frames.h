#pragma once

#include "mr_hand_interaction/replay/recording_csv.h"
#include "mr_hand_interaction/tracking/joints.h"
#include "support/recordings.h"

namespace mrhi::testing {

/// A recording's hands in the world, its device upright on a desk.
inline std::vector<HandFrame> recorded_frames(const std::string& file) {
  const Pose mount{Vector3::Zero(), Quaternion(Eigen::AngleAxisd(0.5 * M_PI, Vector3::UnitX()))};
  std::vector<HandFrame> frames;
  std::vector<std::string> defects;
  for (const JointsFrame& joints : read_recording_csv(file)) {
    std::optional<HandFrame> frame = complete_frame(joints, mount, defects);
    if (frame) frames.push_back(std::move(*frame));
  }
  return frames;
}

}  // namespace mrhi::testing
