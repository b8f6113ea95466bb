#pragma once

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// A vector whose sums have a fixed order, x then y then z. Eigen's order, and with it the last bit, varies
/// with its version and the compiler's vector instructions.
struct Triple {
  double x, y, z;

  double dot(const Triple& o) const { return x * o.x + y * o.y + z * o.z; }
  Triple cross(const Triple& o) const { return {y * o.z - z * o.y, z * o.x - x * o.z, x * o.y - y * o.x}; }
  Triple operator+(const Triple& o) const { return {x + o.x, y + o.y, z + o.z}; }
  Triple operator-(const Triple& o) const { return {x - o.x, y - o.y, z - o.z}; }
  friend Triple operator*(double s, const Triple& v) { return {s * v.x, s * v.y, s * v.z}; }
};

inline Triple triple(const Vector3& v) {
  return {v.x(), v.y(), v.z()};
}
inline Vector3 vector(const Triple& v) {
  return {v.x, v.y, v.z};
}

}  // namespace mrhi
