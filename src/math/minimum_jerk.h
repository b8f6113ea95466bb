#pragma once

namespace mrhi {

/// Fraction 0..1 of the path at the fraction `time` 0..1 of the duration, from rest to rest (Flash & Hogan
/// 1985, Eq. 4). Its speed peaks at 1.875 in the middle.
inline double minimum_jerk(double time) {
  const double t = time <= 0.0 ? 0.0 : (time >= 1.0 ? 1.0 : time);
  return t * t * t * (10.0 - 15.0 * t + 6.0 * t * t);
}

/// The same with given end velocities: position at the fraction `time` 0..1 of `duration` seconds; no
/// acceleration at either end.
template <class Vector>
Vector minimum_jerk(const Vector& from, const Vector& from_velocity, const Vector& to,
                    const Vector& to_velocity, double duration, double time) {
  const double t = time <= 0.0 ? 0.0 : (time >= 1.0 ? 1.0 : time);
  const double t3 = t * t * t, rest = 1.0 - t;
  const double leaving = t + t3 * (-6.0 + 8.0 * t - 3.0 * t * t);
  const double arriving = -(rest + rest * rest * rest * (-6.0 + 8.0 * rest - 3.0 * rest * rest));
  return from + minimum_jerk(t) * (to - from) + duration * (leaving * from_velocity + arriving * to_velocity);
}

}  // namespace mrhi
