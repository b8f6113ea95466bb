#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "closing.h"

namespace mrhi::real_grasps {

/// Another tracker than the one that recorded.
struct Disturbance {
  double noise = 0.0;  ///< white, on each joint and axis, rms [m]
  std::optional<double>
      rate;  ///< frames evenly spaced, joints in between by straight lines [1/s]; else as recorded
  std::uint64_t seed = 1;
};

/// The frames of a recording from `first` to `last` as the tracker has them. The same seed gives the same
/// bits.
std::vector<JointsFrame> disturbed(const std::vector<JointsFrame>& frames, std::size_t first,
                                   std::size_t last, const Disturbance& disturbance);

}  // namespace mrhi::real_grasps
