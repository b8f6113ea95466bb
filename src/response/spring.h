#pragma once

#include "../math/lanes.h"

namespace mrhi {

/// What a spring contact gives at a relative velocity and spin of its ends.
template <typename Real>
struct SpringResponse {
  Triple<Real> force;   ///< on 2 [N]
  Real push;            ///< normal part of the force, >= 0 [N]
  Real wanted_squared;  ///< of the size of the tangential force that would keep it from sliding [N^2]
  Real torque;          ///< on 2 about n [N m]
  // -d force / d velocity of 2 is tangential_slope (1 - n n') + normal_slope n n' - slip d d', symmetric, >=
  // 0 [N s/m].
  Real normal_slope, tangential_slope, slip;
  Triple<Real> drawn;  ///< d times a length: the stretch at the step's end [m]
  Real drawn_squared;  ///< of that length
  Real torque_slope;   ///< -d torque / d spin of 2 [N m s]
};

/// The spring of one contact as the implicit model solves it: where its two ends will be at the end of the
/// step, as a function of their relative velocity then. Body 1 is the hand, or body a; forces are on body 2,
/// the object, or body b. World axes, n from 2 to 1. Real is double, or Wide for four contacts at once.
template <typename Real>
struct Spring {
  // At the step's start.
  Triple<Real> normal;
  Triple<Real> stretch;  ///< along the surface: end on 1 less end on 2 [m]
  Real depth;            ///< [m]
  Real twist;            ///< turn of 1 about n against 2, as far as it is held [rad]

  // What it is made of.
  Real pad;              ///< depth over which it stiffens; 0: at once [m]
  Real half_over_pad;    ///< 1/2 over that; 0 where it is 0 [1/m]
  Real yields;           ///< as deep as this at full stiffness it begins to give way [m]
  Real ahead;            ///< how far ahead the spring is evaluated: the step, and what damping adds [s]
  Real fade;             ///< one over the parting speed at which it gives no push any more, or 0 [s/m]
  Real stiffness;        ///< [N/m]
  Real twist_stiffness;  ///< [N m/rad], 0: a point that turns freely
  Real friction;         ///< Coulomb's coefficient: static while sticking, dynamic while slipping
  Real patch_friction;   ///< torque that the patch bears, over the push [m]
  Real bond;             ///< force along the surface that it bears without any push [N]

  // Coulomb's limits, by the normal force of the last iterate.
  Real slip_limit;   ///< [N]
  Real twist_limit;  ///< [N m]

  /// The push over the stiffness as a function of the depth, and its slope: as that of a pulp, which stiffens
  /// until it is pressed to `pad`, and of a finger, which gives way beyond its strength.
  [[gnu::always_inline]] inline void press(const Real& deep, Real& pressed, Real& steepness) const;

  /// At the relative velocity `u` of 1 at the contact point and the relative spin about n. Renews Coulomb's
  /// limits by the normal force there first, where asked.
  [[gnu::always_inline]] inline void respond(const Triple<Real>& u, const Real& spin, bool renew_limits,
                                             SpringResponse<Real>& response);
};

/// A spring, and where it acts on body 2. Body 1 is a hand or a fixture and moves by itself, if not said
/// otherwise.
template <typename Real>
struct SpringContact {
  Spring<Real> spring;
  SpringResponse<Real> response;  ///< of the last iterate
  Triple<Real> arm;               ///< from the centre of 2 [m]
  Triple<Real> drive;             ///< velocity of 1 at the point [m/s]
  Real drive_spin;                ///< of 1 about n [rad/s]
};

/// What a finger that gives way still gains in push with depth, of its stiffness.
constexpr double kGivingWay = 0.02;

// With d the depth, D the pad, Y what is as much as the strength at full stiffness (`yields`), and k p the
// push:
//
//     p = d^2 / 2D           p' = d / D        d <= D      the pulp stiffens (Serina et al. 1997)
//     p = d - D / 2          p' = 1            d > D       the two meet with the same slope
//     p -> Y + e (p - Y)     p' -> e p'        p > Y       the finger gives way, e = kGivingWay
//
// The slope is zero at d = 0 alone: two fingers that both give way still centre what they hold. Without a
// pad 1 / 2D counts as 0, as infinite it would be 0 times infinity in a lane; without a limit Y is
// infinite, and the third line no number, but then no lane chooses it.
template <typename Real>
inline void Spring<Real>::press(const Real& deep, Real& pressed, Real& steepness) const {
  const Real one = constant<Real>(1.0), part = constant<Real>(kGivingWay);
  const Real soft = lesser(deep, pad);
  pressed = deep - soft + soft * soft * half_over_pad;
  steepness = where_at_most(pad, deep, one, constant<Real>(2.0) * deep * half_over_pad);
  steepness = where_at_most(pressed, yields, steepness, part * steepness);
  pressed = where_at_most(pressed, yields, pressed, yields + part * (pressed - yields));
}

// With k the stiffness, tau = `ahead`, v = n.u > 0 as the two part, s the stretch, P = 1 - n n':
//
//     d+ = max(0, d - tau v)              q+ = s + tau P u               at the step's end
//     N  = k p(d+) (1 - r^2)              r  = min(1, max(0, v) fade)    Eqs. 16, 17; the fade is ours
//     F  = -N n + k q+ min(1, L / k|q+|)  L  = mu N + bond               Eqs. 18 to 20, Coulomb's disc
//     T  = clamp(k_t (theta + tau spin), -L_t, L_t)                      soft finger: L_t = 2/3 mu a N
//
// on body 2. While L and L_t are held these are the gradient by u and spin of a convex function, potential();
// with L a function of N they are of none, which is why the limits are those of the last iterate.
// The fade is Hunt & Crossley's (1975) way of losing energy, a factor on the spring's force, so that
// nothing jumps at the touch; clamped, it does not pull either. It acts as the two part alone, and by the
// square, so that its slope is zero where nothing moves.
// All look ahead by tau where h would do: what tau is beyond h is a dashpot beside each spring (Kelvin and
// Voigt; kRelaxation).
// The slopes, which Newton's method needs, are by the velocity of 2, on which u hangs as u = u_1 - u_2:
//
//     -dF/du_2 = tau k p' (1 - r^2) n n' + 2 k p r fade n n'    along n, where N > 0
//              + tau k P                             sticking
//              + tau L / |q+| (P - q q' / q'q)       slipping, q = q+: it turns but grows no more
//     -dT/dspin_2 = tau k_t, or 0 at the limit
//
// What the limits gain with N, dL/dv, is left out of it: Coulomb's law is not associated (de Saxce & Feng
// 1998), and the matrix with it not symmetric. Held limits are Tresca's friction; that they are renewed
// from iterate to iterate is the fixed point between the two (Haslinger 1983).
template <typename Real>
inline void Spring<Real>::respond(const Triple<Real>& u, const Real& spin, bool renew_limits,
                                  SpringResponse<Real>& response) {
  const Real zero = constant<Real>(0.0), one = constant<Real>(1.0);
  const Real rate = u.dot(normal);
  const Real deep = greater(zero, depth - ahead * rate);
  const Real parting = lesser(greater(rate, zero) * fade, one);
  const Real kept = one - parting * parting;
  Real pressed, steepness;
  press(deep, pressed, steepness);
  const Real push = stiffness * pressed * kept;
  response.push = push;
  // Where N is 0 so is its slope. It has to be said: beyond the release speed r stays 1 and p is not 0, so
  // the fade's part of the formula would be left over.
  const Real steep = steepness * ahead * kept + pressed * parting * (constant<Real>(2.0) * fade);
  response.normal_slope = where_at_most(push, zero, zero, stiffness * steep);
  if (renew_limits) {
    slip_limit = friction * push + bond;
    twist_limit = patch_friction * push;
  }

  response.drawn = stretch + ahead * (u - rate * normal);
  // Sizes are compared by their squares: the root is taken only where something slips.
  response.drawn_squared = response.drawn.dot(response.drawn);
  response.wanted_squared = stiffness * stiffness * response.drawn_squared;
  response.tangential_slope = where_at_most(slip_limit, zero, zero, stiffness * ahead);
  response.slip = zero;
  Real borne = stiffness;
  const Real limit_squared = slip_limit * slip_limit;
  if (any_above(response.wanted_squared, limit_squared)) {
    // Beyond the limit the spring yields: it bears the limit at any stretch.
    // Lanes that stick come along here: the floor keeps 0 / 0 out of theirs, whose result is not taken.
    const Real length = root(greater(response.drawn_squared, constant<Real>(1e-300)));
    borne = where_at_most(response.wanted_squared, limit_squared, stiffness, slip_limit / length);
    response.tangential_slope = where_at_most(slip_limit, zero, zero, borne * ahead);
    response.slip = where_at_most(response.wanted_squared, limit_squared, zero, response.tangential_slope);
  }
  response.force = borne * response.drawn - push * normal;

  // Torque and force have limits of their own here. A real patch that slides bears less torque (the limit
  // surface; Howe & Cutkosky 1996).
  const Real torque = twist_stiffness * (twist + ahead * spin);
  response.torque = greater(zero - twist_limit, lesser(torque, twist_limit));
  const Real size = greater(torque, zero - torque);
  response.torque_slope = where_at_most(twist_limit, size, zero, twist_stiffness * ahead);
}

}  // namespace mrhi
