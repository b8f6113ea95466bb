#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mr_hand_interaction/synthetic/scripted_motion.h"
#include "mr_hand_interaction/synthetic/tracking_noise.h"

namespace mrhi {

struct SyntheticHandOptions {
  std::string motion = "grasp_cube";
  std::string side = "right";
  double rate = 115.0;  ///< frames per second, 1 to 1000
  double noise = 0.0;   ///< amplitude of TrackingNoise, 0 to 10
  std::uint64_t seed = 1;
};

/// A device that sees a scripted hand: its frames one after the other, evenly spaced, stamps from 0.
class SyntheticHand {
 public:
  /// Throws std::invalid_argument that names the option and what is allowed. The device is where
  /// default_device_mount() has it.
  explicit SyntheticHand(const SyntheticHandOptions& options);
  /// Another motion than the options'.
  SyntheticHand(const SyntheticHandOptions& options, const ScriptedMotion& motion);

  const ScriptedMotion& motion() const { return motion_; }
  /// Stamp that the next frame will have.
  Nanoseconds next_stamp() const;
  /// Number of the run that the next frame belongs to, from 0.
  int next_run() const;
  JointsFrame next();

 private:
  ScriptedMotion motion_;
  Side side_;
  double rate_;
  TrackingNoise noise_;
  std::int64_t frame_ = 0;
};

/// One run of the motion and the pause after it.
std::vector<JointsFrame> record_motion(const SyntheticHandOptions& options);
std::vector<JointsFrame> record_motion(const SyntheticHandOptions& options, const ScriptedMotion& motion);

}  // namespace mrhi
