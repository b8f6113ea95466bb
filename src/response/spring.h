#pragma once

#include <algorithm>
#include <cmath>

#include "../math/triple.h"

namespace mrhi {

/// Force and torque of a spring contact at a relative velocity and spin of its ends.
struct SpringResponse {
  Triple force;           ///< on 2 [N]
  double push;            ///< normal part of the force, >= 0 [N]
  double wanted_squared;  ///< of the size of the tangential force that would keep it from sliding [N^2]
  double torque;          ///< on 2 about n [N m]
  // -d force / d velocity of 2 is tangential_slope (1 - n n') + normal_slope n n' - slip d d', symmetric, >=
  // 0 [N s/m].
  double normal_slope, tangential_slope, slip;
  Triple drawn;          ///< d times a length: the stretch at the step's end [m]
  double drawn_squared;  ///< of that length
  double torque_slope;   ///< -d torque / d spin of 2 [N m s]
};

/// The spring of one contact as the implicit model solves it: where its two ends will be at the end of the
/// step, as a function of their relative velocity then. Body 1 is the hand, or body a; forces are on body 2,
/// the object, or body b. World axes, n from 2 to 1.
struct Spring {
  // At the step's start.
  Triple normal;
  Triple stretch;  ///< along the surface: end on 1 less end on 2 [m]
  double depth;    ///< [m]
  double twist;    ///< turn of 1 about n against 2, as far as it is held [rad]

  // What it is made of.
  double pad;              ///< depth over which it stiffens; 0: at once [m]
  double half_over_pad;    ///< 1/2 over that; 0 where it is 0 [1/m]
  double yields;           ///< as deep as this at full stiffness it begins to give way [m]
  double ahead;            ///< how far ahead the spring is evaluated: the step, and what damping adds [s]
  double fade;             ///< one over the parting speed at which it gives no push any more, or 0 [s/m]
  double stiffness;        ///< [N/m]
  double twist_stiffness;  ///< [N m/rad], 0: a point that turns freely
  double friction;         ///< Coulomb's coefficient: static while sticking, dynamic while slipping
  double patch_friction;   ///< torque that the patch bears, over the push [m]
  double bond;             ///< force along the surface that it bears without any push [N]

  // Coulomb's limits, by the normal force of the last iterate.
  double slip_limit;   ///< [N]
  double twist_limit;  ///< [N m]

  /// The push over the stiffness as a function of the depth, and its slope: as that of a pulp, which stiffens
  /// until it is pressed to `pad`, and of a finger, which gives way beyond its strength.
  [[gnu::always_inline]] inline void press(double deep, double& pressed, double& steepness) const;

  /// At the relative velocity `u` of 1 at the contact point and the relative spin about n. Renews Coulomb's
  /// limits by the normal force there first, where asked.
  [[gnu::always_inline]] inline void respond(const Triple& u, double spin, bool renew_limits,
                                             SpringResponse& response);
};

/// A row of an island's contact problem: a spring, and where it acts on its two bodies.
struct SpringContact {
  /// Of a body that is not solved for: a hand, whose motion is `drive`, or a fixture.
  static constexpr int kNone = -1;

  int a, b;  ///< bodies 1 and 2 by their number in the island, or kNone
  Spring spring;
  SpringResponse response;  ///< of the last iterate
  Triple arm_a, arm;        ///< from the centres of 1 and 2 to where friction acts [m]
  Triple tilt;              ///< d x n, with d from there to where the normal force acts [m]
  bool tilts;               ///< true if the tilt is not zero
  Triple drive;             ///< velocity of 1 at the point, where 1 is not solved for [m/s]
  double drive_spin;        ///< likewise its angular velocity about n [rad/s]
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
// pad 1 / 2D counts as 0, as infinite it would be 0 times infinity; without a limit Y is infinite.
inline void Spring::press(double deep, double& pressed, double& steepness) const {
  const double soft = std::min(deep, pad);
  pressed = deep - soft + soft * soft * half_over_pad;
  steepness = pad <= deep ? 1.0 : 2.0 * deep * half_over_pad;
  if (pressed <= yields) return;
  steepness = kGivingWay * steepness;
  pressed = yields + kGivingWay * (pressed - yields);
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
inline void Spring::respond(const Triple& u, double spin, bool renew_limits, SpringResponse& response) {
  const double rate = u.dot(normal);
  const double deep = std::max(0.0, depth - ahead * rate);
  const double parting = std::min(std::max(rate, 0.0) * fade, 1.0);
  const double kept = 1.0 - parting * parting;
  double pressed, steepness;
  press(deep, pressed, steepness);
  const double push = stiffness * pressed * kept;
  response.push = push;
  // Where N is 0 so is its slope. It has to be said: beyond the release speed r stays 1 and p is not 0, so
  // the fade's part of the formula would be left over.
  const double steep = steepness * ahead * kept + pressed * parting * (2.0 * fade);
  response.normal_slope = push <= 0.0 ? 0.0 : stiffness * steep;
  if (renew_limits) {
    slip_limit = friction * push + bond;
    twist_limit = patch_friction * push;
  }

  response.drawn = stretch + ahead * (u - rate * normal);
  // Sizes are compared by their squares: the root is taken only where something slips.
  response.drawn_squared = response.drawn.dot(response.drawn);
  response.wanted_squared = stiffness * stiffness * response.drawn_squared;
  double borne = stiffness;
  const bool slips = response.wanted_squared > slip_limit * slip_limit;
  // Beyond the limit the spring yields: it bears the limit at any stretch.
  if (slips) borne = slip_limit / std::sqrt(std::max(response.drawn_squared, 1e-300));
  response.tangential_slope = slip_limit <= 0.0 ? 0.0 : borne * ahead;
  response.slip = slips ? response.tangential_slope : 0.0;
  response.force = borne * response.drawn - push * normal;

  // Torque and force have limits of their own here. A real patch that slides bears less torque (the limit
  // surface; Howe & Cutkosky 1996).
  const double torque = twist_stiffness * (twist + ahead * spin);
  response.torque = std::max(0.0 - twist_limit, std::min(torque, twist_limit));  // no -0 where the limit is 0
  response.torque_slope = twist_limit <= std::abs(torque) ? 0.0 : twist_stiffness * ahead;
}

}  // namespace mrhi
