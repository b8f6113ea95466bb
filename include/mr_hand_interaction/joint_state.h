#pragma once

#include <cstdint>

namespace mrhi {

/// What changes about one joint. Its velocity is that of the bodies, whose momenta are the state. Units as in
/// scene/joint.h.
struct JointState {
  double position = 0.0;     ///< [rad]
  double anchor = 0.0;       ///< place that friction holds [rad]
  double pushed = 0.0;       ///< acceleration by what acted in the last step: near it lies the next [rad/s^2]
  double effort = 0.0;       ///< that the joint's own forces gave in the last step: its reaction [N m]
  double still = 0.0;        ///< for how long its tree has been as good as at rest [s]
  std::uint8_t detent = 0;   ///< index in Detents::at of the one that it is in
  std::int8_t at_limit = 0;  ///< -1 at the lower one, 1 at the upper one
  bool latched = false;      ///< within the latch's reach
};

}  // namespace mrhi
