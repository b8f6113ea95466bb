#pragma once

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// Share 0..1 of the way done at the share `time` 0..1 of the duration, from rest to rest (Flash & Hogan
/// 1985, Eq. 4). Greatest speed 1.875 at the middle.
double minimum_jerk(double time);

/// The same with velocities at the ends: position after the share `time` 0..1 of `duration` seconds; no
/// acceleration at either end.
Vector3 minimum_jerk(const Vector3& from, const Vector3& from_velocity, const Vector3& to,
                     const Vector3& to_velocity, double duration, double time);

}  // namespace mrhi
