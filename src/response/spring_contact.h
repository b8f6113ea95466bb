#pragma once

#include <algorithm>
#include <cmath>

#include "../math/triple.h"
#include "contact_step.h"
#include "islands.h"
#include "mr_hand_interaction/configuration.h"

namespace mrhi {

/// Force and torque of a spring contact at a given relative velocity and spin of its ends.
struct SpringResponse {
  Triple force;          ///< on 2 [N]
  double normal_force;   ///< normal force, >= 0 [N]
  double trial_squared;  ///< square of the tangential force that would prevent slip [N^2]
  double torque;         ///< on 2 about n [N m]
  // -d force / d velocity of 2 is tangential_slope (1 - n n') + normal_slope n n' - slip d d' [N s/m]:
  // symmetric, positive semidefinite.
  double normal_slope, tangential_slope, slip;
  Triple drawn;          ///< d times a length: the stretch at the end of the step [m]
  double drawn_squared;  ///< square of that length [m^2]
  double torque_slope;   ///< -d torque / d spin of 2 [N m s]
};

/// The spring of a contact along its normal.
struct NormalSpring {
  double depth;          ///< at the start of the step [m]
  double pad;            ///< compression over which a soft pad stiffens; 0: constant stiffness [m]
  double half_over_pad;  ///< 1 / (2 pad); 0 if pad is 0 [1/m]
  double yields;         ///< depth at full stiffness beyond which the finger complies [m]
  double ahead;          ///< look-ahead time of the spring: the step plus damping [s]
  double fade;           ///< 1 / separation speed at which the normal force vanishes; 0: no fade [s/m]
  double stiffness;      ///< beyond the pad [N/m]

  /// Normal force over stiffness as a function of depth, and its slope. The fingertip pad stiffens until it
  /// is compressed to `pad`; the finger complies beyond its strength.
  [[gnu::always_inline]] inline void compress(double deep, double& pressed, double& steepness) const;

  /// Normal force at a rate of the gap [N], and its decrease with the rate [N s/m].
  [[gnu::always_inline]] inline double normal_force(double rate, double& slope) const;
};

/// The spring of one contact in the implicit model: the separation of its ends at the end of the step is a
/// function of their relative velocity then. Body 1 is the hand or body a; forces are on body 2, the object
/// or body b. World axes, n from 2 to 1.
struct Spring : NormalSpring {
  // State at the start of the step.
  Triple normal;
  Triple stretch;  ///< tangential: end on 1 minus end on 2 [m]
  double twist;    ///< elastic rotation of 1 about n relative to 2 [rad]

  // Parameters.
  double shear;            ///< tangential stiffness [N/m]
  double twist_stiffness;  ///< 0: no torsional resistance [N m/rad]
  double friction;         ///< Coulomb's coefficient: static while sticking, dynamic while slipping
  double patch_friction;   ///< torque limit of the patch, over the normal force [m]
  double bond;             ///< tangential force limit without a normal force [N]

  // Coulomb's limits, by the normal force of the last iterate.
  double slip_limit;   ///< [N]
  double twist_limit;  ///< [N m]

  /// Evaluates the spring at the relative velocity `u` of 1 at the contact point and the relative spin about
  /// n. `renew_limits`: first sets Coulomb's limits by the normal force there.
  [[gnu::always_inline]] inline void evaluate(const Triple& u, double spin, bool renew_limits,
                                              SpringResponse& response);
};

/// A row of an island's contact problem: a spring and the points of its two bodies on which it acts.
struct SpringContact {
  /// Number of a body that is not solved for: a hand, whose motion is `drive`, or a fixture.
  static constexpr int kNone = -1;

  int a, b;  ///< numbers of bodies 1 and 2 in the island, or kNone
  Spring spring;
  SpringResponse response;  ///< of the last iterate
  Triple arm_a, arm;        ///< from the centres of 1 and 2 to the point of friction [m]
  Triple tilt;              ///< d x n, with d from that point to the point of the normal force [m]
  bool tilts;               ///< true if the tilt is not zero
  Triple drive;             ///< velocity of 1 at the point, if 1 is not solved for [m/s]
  double drive_spin;        ///< likewise its angular velocity about n [rad/s]
};

/// Stiffness ratio of a finger that complies beyond its strength.
constexpr double kYieldedStiffness = 0.02;

// With d the depth, D the pad, Y the depth at full stiffness for the finger's strength (`yields`), and k p
// the normal force:
//
//     p = d^2 / 2D           p' = d / D        d <= D      the pad stiffens (Serina et al. 1997)
//     p = d - D / 2          p' = 1            d > D       the two meet with the same slope
//     p -> Y + e (p - Y)     p' -> e p'        p > Y       the finger complies, e = kYieldedStiffness
//
// The slope is zero only at d = 0, so two fingers that both comply still centre the object between them.
// Without a pad 1 / 2D is 0, as infinity would give 0 times infinity. Without a strength limit Y is infinite.
inline void NormalSpring::compress(double deep, double& pressed, double& steepness) const {
  const double soft = std::min(deep, pad);
  pressed = deep - soft + soft * soft * half_over_pad;
  steepness = pad <= deep ? 1.0 : 2.0 * deep * half_over_pad;
  if (pressed <= yields) return;
  steepness = kYieldedStiffness * steepness;
  pressed = yields + kYieldedStiffness * (pressed - yields);
}

// With k the stiffness, tau = `ahead`, v = n.u > 0 for separation, s the stretch, P = 1 - n n':
//
//     d+ = max(0, d - tau v)              q+ = s + tau P u               at the step's end
//     N  = k p(d+) (1 - r^2)              r  = min(1, max(0, v) fade)    Eqs. 16, 17; the fade is ours
//     F  = -N n + k_s q+ min(1, L / k_s|q+|)  L = mu N + bond            Eqs. 18 to 20, Coulomb's disc
//     T  = clamp(k_t (theta + tau spin), -L_t, L_t)                      soft finger: L_t = 2/3 mu a N
//
// k_s is the pad's slope k p' at the start of the step, and the anchor moves so that F stays as k_s changes:
// dF = k_s dq, as dN = k p' dd. So shear and pressure grow and fall together (Mindlin 1949): a finger that
// presses a slope of the angle a has F / N = tan a from the first touch on. With k it would slip at first, on
// any slope.
//
// F and T act on body 2. While L and L_t are held, they are the gradient by u and spin of a convex function,
// potential(). With L a function of N no such function exists, so the limits are those of the last iterate.
//
// The fade is Hunt & Crossley's (1975) dissipation: a factor on the spring's force, so the force is
// continuous at first touch. It is clamped, so it never pulls. It acts during separation only, and is
// quadratic, so its slope is zero at rest.
//
// All springs look ahead by tau, at least h: a dashpot k tau in parallel with each spring (Kelvin and Voigt;
// kRelaxation).
//
// Newton's method needs the slopes by the velocity of 2, where u = u_1 - u_2:
//
//     -dF/du_2 = tau k p' (1 - r^2) n n' + 2 k p r fade n n'    along n, where N > 0
//              + tau k_s P                           sticking
//              + tau L / |q+| (P - q q' / q'q)       slipping, q = q+: it turns but grows no more
//     -dT/dspin_2 = tau k_t, or 0 at the limit
//
// The slopes omit dL/dv, the change of the limits with N: Coulomb's law is not associated (de Saxce & Feng
// 1998), so the matrix would not be symmetric. Held limits are Tresca's friction; renewing them from iterate
// to iterate is the fixed-point iteration to Coulomb's (Haslinger 1983).
inline double NormalSpring::normal_force(double rate, double& slope) const {
  const double deep = std::max(0.0, depth - ahead * rate);
  const double parting = std::min(std::max(rate, 0.0) * fade, 1.0);
  const double kept = 1.0 - parting * parting;
  double pressed, steepness;
  compress(deep, pressed, steepness);
  const double force = stiffness * pressed * kept;
  // Where N is 0 its slope is 0 too. Beyond the release speed r stays 1 and p is not 0, so the formula's fade
  // term alone would not vanish.
  const double steep = steepness * ahead * kept + pressed * parting * (2.0 * fade);
  slope = force <= 0.0 ? 0.0 : stiffness * steep;
  return force;
}

inline void Spring::evaluate(const Triple& u, double spin, bool renew_limits, SpringResponse& response) {
  const double rate = u.dot(normal);
  const double load = response.normal_force = normal_force(rate, response.normal_slope);
  if (renew_limits) {
    slip_limit = friction * load + bond;
    twist_limit = patch_friction * load;
  }

  response.drawn = stretch + ahead * (u - rate * normal);
  // Squared sizes are compared, so the root is taken only if the contact slips.
  response.drawn_squared = response.drawn.dot(response.drawn);
  response.trial_squared = shear * shear * response.drawn_squared;
  double secant = shear;
  const bool slips = response.trial_squared > slip_limit * slip_limit;
  // A slipping spring has its limit force at any stretch.
  if (slips) secant = slip_limit / std::sqrt(std::max(response.drawn_squared, 1e-300));
  response.tangential_slope = slip_limit <= 0.0 ? 0.0 : secant * ahead;
  response.slip = slips ? response.tangential_slope : 0.0;
  response.force = secant * response.drawn - load * normal;

  // Torque and force have separate limits here. A real patch has a lower torque limit while it slides (the
  // limit surface; Howe & Cutkosky 1996).
  const double torque = twist_stiffness * (twist + ahead * spin);
  response.torque = std::max(0.0 - twist_limit, std::min(torque, twist_limit));  // no -0 where the limit is 0
  response.torque_slope = twist_limit <= std::abs(torque) ? 0.0 : twist_stiffness * ahead;
}

/// Makes the spring of a contact with a hand, or of one between bodies. A contact without share has no
/// stiffness.
void make_spring(const ContactStep& step, const Contact& contact, SpringContact& result);
void make_spring(const ContactStep& step, const BodyContact& contact, SpringContact& result);
Spring spring_of(const ContactStep& step, const BodyContact& contact);

/// Writes the solution of a contact back.
void settle(const ContactStep& step, const SpringContact& solved, Contact& contact);
void settle(const ContactStep& step, const SpringContact& solved, BodyContact& contact);

/// Look-ahead time of a spring: the step plus damping [s]. An open contact has no damping.
double look_ahead(double step, bool damping, bool touches = true);

/// Convex function of the velocities whose gradient is the response under the present limits [W].
double potential(const Spring& spring, const Triple& u, double spin);

/// Makes the rows of the hands' contacts with an island, and of its grips.
void make_hand_rows(const ContactStep& step, const Island& island, std::vector<SpringContact>& rows);
/// Makes the row of a contact between bodies of the island, or of one of them with a fixture.
void make_link_row(const ContactStep& step, const Island& island, const BodyContact& contact,
                   SpringContact& row);

/// Writes back the solution of the rows of make_hand_rows(). Returns the row after them.
const SpringContact* settle_hand_rows(ContactStep& step, const Island& island, const SpringContact* row);

}  // namespace mrhi
