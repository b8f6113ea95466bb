#pragma once

#include <cstdint>
#include <random>

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// Numbers that are the same on every machine (the standard fixes the engine, not its distributions).
class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}
  double between(double lo, double hi) { return lo + (hi - lo) * (engine_() / 4294967296.0); }
  int below(int n) { return static_cast<int>(engine_() % static_cast<std::uint32_t>(n)); }
  double sign() { return below(2) == 0 ? -1.0 : 1.0; }
  Vector3 in_box(const Vector3& half) {
    const double x = between(-half.x(), half.x()), y = between(-half.y(), half.y());
    return {x, y, between(-half.z(), half.z())};
  }
  Vector3 direction() {
    while (true) {
      const Vector3 v = in_box(Vector3::Ones());
      if (v.norm() > 0.1 && v.norm() <= 1.0) return v.normalized();
    }
  }

 private:
  std::mt19937 engine_;
};

inline Capsule capsule_about(const Vector3& middle, const Vector3& along, double radius) {
  return {middle - 0.5 * along, middle + 0.5 * along, radius};
}

/// A capsule that is `gap` away from a convex surface whose outward normal at `point` may be `normal`; it
/// faces the point with an end or with its side.
inline Capsule capsule_facing(Random& random, const Vector3& point, const Vector3& normal, double gap) {
  const double radius = random.between(0.005, 0.012), length = random.between(0.005, 0.06);
  const Vector3 axis_point = point + (radius + gap) * normal;
  Vector3 along = random.direction();
  const double rise = normal.dot(along);
  if (random.below(2) == 0) {
    along = (along - rise * normal).normalized() * length;
    const double s = random.between(0, 1);
    return {axis_point - s * along, axis_point + (1 - s) * along, radius};
  }
  if (rise < 0) along = -along;
  if (random.below(2) == 0) return {axis_point, axis_point + length * along, radius};
  return {axis_point + length * along, axis_point, radius};
}

/// Gaps of capsules that touch: exactly, by little, and overlapping up to almost the whole radius [m].
inline double touching_gap(Random& random) {
  switch (random.below(4)) {
    case 0:
      return 0.0;
    case 1:
      return random.between(-1e-6, 1e-6);
    case 2:
      return random.between(-0.001, 0.001);
    default:
      return random.between(-0.0049, 0.005);
  }
}

}  // namespace mrhi
