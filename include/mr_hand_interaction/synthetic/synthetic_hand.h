#pragma once

#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

#include "mr_hand_interaction/synthetic/random.h"
#include "mr_hand_interaction/synthetic/scripted_motion.h"
#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {

/// Noise like that of a Leap Motion, times `amplitude`: white on every joint, 0.2 mm rms at rest and 1.2 mm
/// from 1 m/s on, and 0.2 mm rms common to the whole hand. The same seed and frames give the same bits.
class TrackingNoise {
 public:
  TrackingNoise(double amplitude, std::uint64_t seed) : amplitude_(amplitude), random_(seed) {}

  /// Adds noise to a frame. Call with frames in the order of their stamps.
  void apply(JointsFrame& frame);

 private:
  void disturb(HandJoints& hand, const HandJoints* before, double elapsed);

  double amplitude_;
  Random random_;
  JointsFrame previous_;
};

struct SyntheticHandOptions {
  std::string motion = "grasp_cube";
  std::string side = "right";
  double rate = 115.0;  ///< frames per second, 1 to 1000
  double noise = 0.0;   ///< amplitude of TrackingNoise, 0 to 10
  std::uint64_t seed = 1;
};

/// A device that sees a scripted hand: evenly spaced frames, with stamps from 0.
class SyntheticHand {
 public:
  /// Throws std::invalid_argument with the option and what is allowed. The device is at
  /// default_device_mount().
  explicit SyntheticHand(const SyntheticHandOptions& options);
  /// Uses another motion than that of the options.
  SyntheticHand(const SyntheticHandOptions& options, const ScriptedMotion& motion);

  const ScriptedMotion& motion() const { return motion_; }
  /// Stamp of the next frame.
  Nanoseconds next_stamp() const;
  /// Index of the next frame's run, from 0.
  int next_run() const;
  JointsFrame next();

 private:
  ScriptedMotion motion_;
  Side side_;
  double rate_;
  TrackingNoise noise_;
  std::int64_t frame_ = 0;
};

/// Records one run of the motion and the pause after it.
std::vector<JointsFrame> record_motion(const SyntheticHandOptions& options);
std::vector<JointsFrame> record_motion(const SyntheticHandOptions& options, const ScriptedMotion& motion);

/// Writes frames in the CSV schema of recordings: one line per hand and frame, hand_id -1 for a frame without
/// hands, time from the first stamp, micrometres. Missing values are empty.
void write_recording_csv(std::ostream& out, const std::vector<JointsFrame>& frames);

}  // namespace mrhi
