#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mr_hand_interaction/tracking/hand.h"

namespace mrhi {

/// One hand as a tracker reports it: joint positions in the device's frame, with gaps. All lengths in metres.
struct HandJoints {
  std::uint32_t id = 0;
  Side side = Side::right;
  float confidence = 1.0f;
  float grab_strength = 0.0f;
  float pinch_strength = 0.0f;
  std::optional<Vector3> palm_centre;
  std::optional<float> palm_width;
  std::optional<Vector3> wrist;
  /// joints[f][0..4]: metacarpal base, metacarpal end, proximal end, intermediate end, tip (the recordings'
  /// j0..j4).
  std::array<std::array<std::optional<Vector3>, 5>, kFingers> joints;
  std::array<std::optional<float>, kFingers> finger_width;  ///< diameter
  /// Diameters of single bones, which take precedence over the finger's.
  std::array<std::array<std::optional<float>, kBonesPerFinger>, kFingers> bone_width;
};

struct JointsFrame {
  Nanoseconds stamp = 0;
  std::vector<HandJoints> hands;
};

/// Reason why a hand is unusable ("index tip is not finite"); empty if it is usable.
std::string defect(const HandJoints& hand);

/// Fills missing parts (palm, wrist, metacarpals, radii) from anatomy, places the hand in world by the
/// device's pose and derives its orientation from the joints alone. Wrist and sizes are rounded to float32 as
/// in the messages, so that a live node and a replay, and every version of a driver's message, give the same
/// bits. Throws std::invalid_argument if the hand has a defect.
Hand complete_hand(const HandJoints& joints, const Pose& device_in_world);

/// The frame with the hands that have no defect. Adds each defect to `defects`. Nothing if there were hands
/// and none is usable, so that the last usable frame remains.
std::optional<HandFrame> complete_frame(const JointsFrame& joints, const Pose& device_in_world,
                                        std::vector<std::string>& defects);

/// The capsule of the palm, along the palm's x through its centre. Proportions: 0.4 and 0.15 palm widths.
Capsule palm_capsule(const Pose& palm, double palm_width);

}  // namespace mrhi
