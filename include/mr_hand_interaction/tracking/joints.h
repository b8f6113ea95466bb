#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mr_hand_interaction/tracking/hand.h"

namespace mrhi {

/// One hand as a tracker reports it: joint positions in the device's frame, some of them missing. Lengths in
/// metres.
struct HandJoints {
  std::uint32_t id = 0;
  Side side = Side::right;
  float confidence = 1.0f;
  float grab_strength = 0.0f;
  float pinch_strength = 0.0f;
  std::optional<Vector3> palm_centre;
  std::optional<float> palm_width;
  std::optional<Vector3> wrist;
  /// joints[f][0..4]: metacarpal base, metacarpal end, proximal end, intermediate end, tip (j0..j4 in
  /// recordings).
  std::array<std::array<std::optional<Vector3>, 5>, kFingers> joints;
  std::array<std::optional<float>, kFingers> finger_width;  ///< diameter
  /// Diameter of single bones; takes precedence over the finger's.
  std::array<std::array<std::optional<float>, kBonesPerFinger>, kFingers> bone_width;
};

struct JointsFrame {
  Nanoseconds stamp = 0;
  std::vector<HandJoints> hands;
};

/// Returns the reason why a hand is unusable ("index tip is not finite"), or an empty string.
std::string defect(const HandJoints& hand);

/// Computes what the tracker did not report (palm, wrist, metacarpals, radii) from anatomy, and the
/// orientation from the joints alone. Transforms the hand to world by the device's pose. Wrist and sizes are
/// rounded to float32 as in the messages, so that a live node, a replay and every version of a driver's
/// message give the same bits. Throws std::invalid_argument if the hand has a defect.
Hand complete_hand(const HandJoints& joints, const Pose& device_in_world);

/// The frame with those hands that have no defect; appends each defect to `defects`. Empty if no hand is
/// usable although some were reported, so that the last good frame stays.
std::optional<HandFrame> complete_frame(const JointsFrame& joints, const Pose& device_in_world,
                                        std::vector<std::string>& defects);

/// Capsule of the palm, along the palm's x through its centre. Proportions: 0.4 and 0.15 palm widths.
Capsule palm_capsule(const Pose& palm, double palm_width);

}  // namespace mrhi
