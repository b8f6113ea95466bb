#pragma once

#include <cstdint>
#include <vector>

#include "tracked_points.h"

namespace mrhi {

/// Reads a serialised leap_motion_controller/Hand as casado-fdo/leap-motion-ros publishes it: one hand, whose
/// side only the topic tells, without its wrist. Throws DecodeError.
TrackedHands read_leap_controller(std::vector<std::uint8_t>& bytes);

}  // namespace mrhi
