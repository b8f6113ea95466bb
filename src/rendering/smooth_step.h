#pragma once

#include <algorithm>

namespace mrhi {

/// 0 at `from`, 1 at `to`, constant beyond, with no kink; `from` may be the greater.
inline double smooth_step(double from, double to, double x) {
  const double t = std::min(1.0, std::max(0.0, (x - from) / (to - from)));
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace mrhi
