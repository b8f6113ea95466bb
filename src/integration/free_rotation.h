#pragma once

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// How a body that nothing twists has turned after `step` seconds: body axes, as it ends against as it began.
/// `inverse_moments` are 1/I along its principal axes [1/(kg m^2)], which are the axes here, the second
/// between the others; `momentum` is its angular momentum [kg m^2/s] in them as the step begins, not zero.
///
/// Not unit: the caller has to divide by its norm. Exact to rounding for turns of up to about kFreeTurn.
///
/// The momentum goes by the addition theorem of Jacobi's elliptic functions, written so that it knows no
/// amplitudes: with J = 1/I, j = (J3 - J2, J1 - J3, J2 - J1), 2 the intermediate axis, and S, c, d the
/// functions of A = -j1 (j2 m3^2 - j3 m2^2) and B = -j3 (j2 m1^2 - j1 m2^2) with S' = c d, c^2 = 1 - A S^2,
/// d^2 = 1 - B S^2 (sn, cn and dn, but for scale),
///
///     m1(t) = (m1 c + j1 m2 m3 S d) / D      D = 1 - j1 j3 m2^2 S^2
///     m2(t) = (m2 c d + j2 m1 m3 S) / D
///     m3(t) = (m3 d + j3 m1 m2 S c) / D
///
/// which holds for tops, symmetric bodies and on the separatrix alike. About the momentum the body turns by
/// (Montgomery 1991: 2 E t / L less the area between the path of m and its chord)
///
///     L * integral of (2 E + m(0) . J m(t)) / (L^2 + m(0) . m(t)) dt,
///
/// by Lobatto's five points, which are exact to rounding as far as a step goes. Short turns have a way of
/// their own (free_flight.cpp).
Quaternion free_rotation(const Vector3& inverse_moments, const Vector3& momentum, double step);

/// Rate at which `momentum` turns in the body, at most, times the step, in one free_rotation [rad].
constexpr double kFreeTurn = 0.25;

}  // namespace mrhi
