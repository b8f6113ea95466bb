#pragma once

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// All points within `radius` of the segment start..end [m]. Radius 0 means absent.
struct Capsule {
  Vector3 start = Vector3::Zero();
  Vector3 end = Vector3::Zero();
  double radius = 0.0;

  /// Point of the axis at s in 0..1.
  Vector3 axis_point(double s) const { return start + s * (end - start); }
  Vector3 centre() const { return 0.5 * (start + end); }
};

}  // namespace mrhi
