#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {

/// Serialises frames as leap_motion/Human messages, in the newest version of the ros-drivers package, without
/// depending on it.
class LeapHumanEncoder {
 public:
  static const char* type() { return "leap_motion/Human"; }
  static const char* md5() { return "2817a017ab58b244566892058c4f6e6d"; }
  /// Full text of the message definition, those of its parts after it.
  static const std::string& definition();

  /// The message's bytes. Frame in the device's frame, at most one hand of a side; throws
  /// std::invalid_argument for two. What a hand lacks is zero or missing from its list, as the driver has it.
  /// Bone orientations are those of Leap (z to the wrist, y out of the back), conjugated as the driver
  /// publishes them.
  static std::vector<std::uint8_t> encode(const JointsFrame& frame, const std::string& frame_id,
                                          std::uint32_t sequence, float frames_per_second);
};

}  // namespace mrhi
