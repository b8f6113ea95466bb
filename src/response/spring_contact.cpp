#include "spring_contact.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "penetration_model.h"

namespace mrhi {
namespace {

/// Relaxation time of the contact's damping: a spring with a dashpot in parallel (Kelvin-Voigt) looks ahead
/// by it [s].
///
/// Backward Euler solves k (q + h q') at the end of the step. With q the present place and q' the velocity of
/// the step, which is centred on its end, k q alone would neither gain nor lose energy (it is the leapfrog):
/// all of k h q' is a dashpot. With e = max(h, tau) in place of h the dashpot is k tau at every step up to
/// tau. So a held object comes to rest equally fast at all these steps, and faster at longer ones. A smaller
/// e of 2/3 h would keep the dashpot at 8 ms too, with 1/7 of the error of a shaken cube. But hard contacts
/// would oscillate, and the error of a door's force would be 3 times as large.
constexpr double kRelaxation = 0.0055;

/// Lever arm of the tangential springs of a fingertip's contact patch, by which they resist spin about the
/// normal [m].
constexpr double kTwistLever = 0.025;

/// Friction torque of a patch with uniform pressure, over friction times normal force times radius: the mean
/// distance of a disc's points from its centre.
///
/// T = integral of mu p r dA over a disc of radius a with p = N / (pi a^2), which is mu N (2 / a^2) a^3 / 3 =
/// 2/3 mu N a. Hertz's pressure, which falls towards the rim, would give 3 pi / 16 mu N a, an eighth less.
/// The radius is Hertz's a = sqrt(R d) (collision/god_object.cpp).
constexpr double kPatchTorque = 2.0 / 3.0;

/// Smallest part of the pad's stiffness that shear has: at none the anchor would have no place.
constexpr double kMinShearRatio = 0.02;

/// Part of its final stiffness that the pad has at its depth; 0 without a pad.
double engaged(const Contact& contact, double pad) {
  return pad > 0.0 ? std::clamp(contact.pressed() / pad, kMinShearRatio, 1.0) : 0.0;
}

/// Stretch of the anchor that keeps its force as the stiffness changes, over its stretch.
double kept_stretch(const Contact& contact, double now) {
  return now > 0.0 ? contact.engaged / now : 1.0;
}

/// From the anchor to the phalanx along the surface, with p moved back to the surface along its path [m].
Vector3 tangential_reach(const Contact& contact) {
  const Vector3 reach = contact.hand_point - contact.point + contact.lever;
  return reach - contact.normal.dot(reach) * contact.normal;
}

double friction_of(const Material& material, Friction friction) {
  return friction == Friction::slipping ? material.dynamic_friction : material.static_friction;
}

/// Distance by which the anchor on body 2 slides along the surface: the part of the motion that spring and
/// dashpot do not take up.
///
/// Friction limits spring and dashpot to k (s + e s') = F with |F| <= phi N, so the stretch relaxes to F / k:
///
///     s(h) = s + (h / e) (F / k - s)          e = `ahead`, with s' = (s(h) - s) / h
///     slide = s + h u_t - s(h)                h u_t = (h / e) (q+ - s)
///
/// Without the dashpot, e = h, the anchor is dragged to where the spring has just F (Eq. 20, and the god
/// object of Zilles & Salisbury 1995). The limit of F is that of the friction state before the step. If that
/// was mu, `rim` scales F to phi N.
Vector3 slide(const SpringContact& solved, double dynamic_friction, double step) {
  const Spring& spring = solved.spring;
  const SpringResponse& response = solved.response;
  // The ends separate by h u = (h / ahead) (drawn - stretch). Spring and dashpot take up (h / ahead) (F / k -
  // stretch) of it, the extension by the force F at the rim in h. The rest is sliding.
  const double followed = step / spring.ahead;
  const Vector3 drawn = vector(response.drawn), stretch = vector(spring.stretch);
  const Vector3 tangential = vector(response.force + response.normal_force * spring.normal);
  const double rim = std::min(1.0, dynamic_friction * response.normal_force / tangential.norm());
  const Vector3 kept = stretch + followed * (rim * tangential / spring.shear - stretch);
  return stretch + followed * (drawn - stretch) - kept;
}

/// Sliding speed up to which friction stays static [m/s].
///
/// Friction falls from mu to phi when surfaces slide, not when the force of one point reaches its limit. The
/// corners of a block on a ramp, or the phalanges below it, carry unequal loads and slip one after the other
/// before the block slides. A momentary dip of the load after a landing starts no slide. A slide this slow
/// stops within 10 um. In long steps the limit is the speed gained by falling for a step.
constexpr double kStaticSpeed = 0.01;

/// Elastic part of the twist after the step. As in slide(): theta(h) = theta + (h / e) (T / k_t - theta),
/// which is theta + h spin while T is within its limit. A contact without torsional stiffness keeps its
/// twist, as the quotient is undefined.
double kept_twist(const SpringContact& solved, double step) {
  const Spring& spring = solved.spring;
  if (spring.twist_stiffness <= 0.0) return spring.twist;
  const double followed = step / spring.ahead;
  return spring.twist + followed * (solved.response.torque / spring.twist_stiffness - spring.twist);
}

/// Writes force and friction state. Returns the displacement of the anchor on the body [m].
///
///     sticks:     |k q+| <= L
///     creeps:     |k q+| > L, and it would slide under mu by no more than the static speed
///
/// The step just solved used the limit L of the previous friction state, mu N or phi N. The new state sets
/// that of the next step. An open contact, N = 0, does not slide.
template <typename Touch>
Vector3 settle_contact(const ContactStep& step, const SpringContact& solved, const Material& material,
                       Touch& touch, double grip = 1.0) {
  const double limit = solved.spring.slip_limit;
  touch.force = vector(solved.response.force);
  touch.friction = solved.response.trial_squared <= limit * limit ? Friction::sticking : Friction::slipping;
  if (touch.friction == Friction::sticking || solved.response.normal_force <= 0.0) return Vector3::Zero();
  const double speed = std::max(kStaticSpeed, step.step * step.gravity.norm());
  const Vector3 crept = slide(solved, grip * material.static_friction, step.step);
  if (crept.norm() > speed * step.step) return slide(solved, grip * material.dynamic_friction, step.step);
  touch.friction = Friction::creeping;
  return crept;
}

}  // namespace

// e = max(h, tau): see kRelaxation. A gap is a spring of depth < 0, which closes by the end of the step if h
// u.n < depth. With the dashpot's time in place of h it would act on bodies that only approach.
double look_ahead(double step, bool damping, bool touches) {
  return damping && touches ? std::max(step, kRelaxation) : step;
}

// The share scales the stiffness, so that N = k share d sums to the phalanx's load, and the strength.
// Friction and patch belong to the single point. Friction is that of the previous state, mu or phi: settle()
// finds the new one.
void make_spring(const ContactStep& step, const Contact& contact, SpringContact& result) {
  const ContactConfiguration& configuration = step.configuration;
  const Body& body = step.scene.bodies[contact.key.body];
  const Triple n = triple(contact.normal), point = triple(contact.point);
  const HandStrength& hand = configuration.hand;
  const double now = engaged(contact, hand.pad);
  Spring& spring = result.spring;
  spring.normal = n;
  spring.stretch = triple(kept_stretch(contact, now) * tangential_reach(contact));  // Eqs. 16 to 18
  spring.depth = contact.pressed();
  spring.twist = contact.twist;
  spring.ahead = look_ahead(step.step, configuration.damping, spring.depth > 0.0);
  spring.fade = release_fade(configuration.release_fade);
  spring.pad = hand.pad;
  spring.half_over_pad = hand.pad > 0.0 ? 0.5 / hand.pad : 0.0;
  spring.stiffness = body.material.stiffness * contact.share;
  spring.shear = hand.pad > 0.0 ? spring.stiffness * now : spring.stiffness;
  // Depth of a spring at full stiffness [m].
  spring.yields = contact.strength / std::max(spring.stiffness, 1e-300);
  spring.bond = 0.0;
  // Springs k at a lever arm l: a rotation by 1 rad stretches them by l, and they apply k l at that arm.
  spring.twist_stiffness = configuration.torsion ? spring.stiffness * (kTwistLever * kTwistLever) : 0.0;
  spring.friction = contact.grip * friction_of(body.material, contact.friction);
  spring.patch_friction = kPatchTorque * spring.friction * contact.patch;
  result.arm = point - triple(step.bodies[contact.key.body].pose.position);
  result.tilts = false, result.tilt = result.arm_a = {0.0, 0.0, 0.0};
  result.drive = triple(contact.hand_velocity);
  result.drive_spin = contact.hand_spin;
}

// The stretch is that of the anchors; no state is kept along n. No pad and no torsion: the points of a
// manifold share the load, and resist twist together.
Spring spring_of(const ContactStep& step, const BodyContact& contact) {
  const ContactConfiguration& configuration = step.configuration;
  Spring spring;
  spring.normal = triple(contact.normal);
  spring.stretch = triple(contact.stretch);
  spring.depth = contact.depth;
  spring.ahead = look_ahead(step.step, configuration.damping, spring.depth > 0.0);
  spring.fade = release_fade(configuration.release_fade);
  spring.stiffness = spring.shear = configuration.object_stiffness * contact.share;
  spring.friction = friction_of(contact.material, contact.friction);
  spring.twist = spring.twist_stiffness = spring.patch_friction = 0.0;
  spring.pad = spring.half_over_pad = spring.bond = 0.0;
  spring.yields = HandStrength::kUnlimited;
  return spring;
}

// Body a moves too: its velocity is the solver's, not `drive`.
void make_spring(const ContactStep& step, const BodyContact& contact, SpringContact& result) {
  result.spring = spring_of(step, contact);
  result.arm_a = triple(contact.arm_a + contact.friction_offset);
  result.arm = triple(contact.arm_b + contact.friction_offset);
  result.tilt = triple(contact.normal.cross(contact.friction_offset));
  result.tilts = !contact.friction_offset.isZero(0.0);
  result.drive = {0.0, 0.0, 0.0};
  result.drive_spin = 0.0;
}

void settle(const ContactStep& step, const SpringContact& solved, Contact& contact) {
  const double now = engaged(contact, solved.spring.pad);
  if (now != contact.engaged) {
    const Vector3 moved = (1.0 - kept_stretch(contact, now)) * tangential_reach(contact);
    contact.god_object = step.bodies[contact.key.body].pose.to_local(contact.point + moved);
    contact.engaged = now;
  }
  contact.twist = kept_twist(solved, step.step);
  contact.torque = solved.response.torque;
  const Material& material = step.scene.bodies[contact.key.body].material;
  const Vector3 slid = settle_contact(step, solved, material, contact, contact.grip);
  if (slid.isZero(0.0)) return;
  const Pose& pose = step.bodies[contact.key.body].pose;
  contact.god_object = pose.to_local(pose * contact.god_object + slid - contact.lever);
}

void settle(const ContactStep& step, const SpringContact& solved, BodyContact& contact) {
  const Vector3 slid = settle_contact(step, solved, contact.material, contact);
  if (slid.isZero(0.0)) return;
  const Pose& pose = step.bodies[contact.key.b].pose;
  contact.anchor_b = pose.to_local(pose * contact.anchor_b + slid);
}

namespace {

/// Integral of min(k q, limit) from 0 to q: energy of a spring with a force limit. Huber's function:
///
///     E(q) = k q^2 / 2                k q <= L
///     E(q) = L q - L^2 / 2k           beyond: value L^2 / 2k and slope L meet at q = L / k
double yielding_energy(double stiffness, double stretch, double limit) {
  if (stiffness * stretch <= limit) return 0.5 * stiffness * stretch * stretch;
  return limit * stretch - 0.5 * limit * limit / stiffness;
}

/// Gauss-Legendre quadrature with three points, exact for polynomials up to degree five. The normal force is
/// a quartic between its kinks: p is quadratic in the depth, which is linear in the rate, times 1 - r^2.
template <typename Function>
double integral(double from, double to, Function function) {
  const double middle = 0.5 * (from + to), half = 0.5 * (to - from), offset = std::sqrt(0.6) * half;
  return half / 9.0 *
         (5.0 * function(middle - offset) + 8.0 * function(middle) + 5.0 * function(middle + offset));
}

/// Depth at which the finger begins to comply: Spring::press() solved for p(d) = Y. d = Y + D / 2 beyond the
/// pad, where p >= D / 2, and d = sqrt(2 Y D) within it.
double yielding_depth(const Spring& spring) {
  if (spring.yields >= 0.5 * spring.pad) return spring.yields + 0.5 * spring.pad;
  return std::sqrt(2.0 * spring.yields * spring.pad);
}

/// Integral of the normal force from `rate` up to where it vanishes, piece by piece; each is a polynomial.
///
///     E_N(v) = integral of N(x) dx from v on,     dE_N/dv = -N(v)
///
/// The kinks are where the finger begins to comply, where the pad ends, at rest, where the fade begins, and
/// where the force ends: at d+ = 0 or at the release speed, whichever is slower.
double normal_energy(const Spring& spring, double rate) {
  const auto rate_at = [&](double depth) { return (spring.depth - depth) / spring.ahead; };
  const double end = spring.fade > 0.0 ? std::min(rate_at(0.0), 1.0 / spring.fade) : rate_at(0.0);
  std::array<double, 4> kinks{rate_at(yielding_depth(spring)), rate_at(spring.pad), 0.0, end};
  std::sort(kinks.begin(), kinks.end());
  double energy = 0.0, from = rate;
  for (const double kink : kinks) {
    const double to = std::min(kink, end);
    if (to <= from) continue;
    double slope;
    energy += integral(from, to, [&](double x) { return spring.normal_force(x, slope); });
    from = to;
  }
  return energy;
}

}  // namespace

// V(u) = E_N(v) + (E_F(|q+|) + E_T(|theta+|)) / tau. E_N is the integral of N from v on; E_F and E_T are
// energies of springs with the force limits L and L_t (Huber's function). d/du of E_F / tau is F, as q+ grows
// by tau P u. The force is minus the gradient. With Coulomb's limits held V is convex, as each force falls
// while its own rate grows. So the step has one solution, and a line search along Newton's direction finds
// it.
//
// In watts, a force times a velocity: the rate form of an incremental potential (Kane et al. 2000), an energy
// over the time tau.
double potential(const Spring& spring, const Triple& u, double spin) {
  const double rate = u.dot(spring.normal);
  const Triple drawn = spring.stretch + spring.ahead * (u - rate * spring.normal);
  const double turned = std::abs(spring.twist + spring.ahead * spin);
  return normal_energy(spring, rate) +
         (yielding_energy(spring.shear, std::sqrt(drawn.dot(drawn)), spring.slip_limit) +
          yielding_energy(spring.twist_stiffness, turned, spring.twist_limit)) /
             spring.ahead;
}

namespace {

/// Makes the spring of one point of a grip. Without normal and depth it acts alike in all directions, and its
/// limit is the bond alone: a Coulomb contact whose limit does not depend on a normal force.
///
///     F = k q+ min(1, bond / k|q+|)       q+ = s + tau u, all of u: n = 0 makes P the identity
///
/// Depth and fade are 0, so N is 0. The four points are corners of a tetrahedron: by forces alone they
/// support torques about any axis.
void make_grip_spring(const ContactStep& step, const Grip& grip, int point, SpringContact& result) {
  const Pose& pose = step.bodies[grip.body].pose;
  const Vector3 on_body = pose * grip.in_body[point];
  result = SpringContact();
  result.spring.stretch = triple(grip.point[point] - on_body);
  result.spring.ahead = look_ahead(step.step, step.configuration.damping);
  result.spring.stiffness = result.spring.shear = grip.stiffness;
  result.spring.yields = HandStrength::kUnlimited;
  result.spring.bond = grip.bond;
  result.arm = triple(on_body - pose.position);
  result.drive = triple(grip.velocity[point]);
}

/// Writes the solution of one grip point back; if it slips, its anchor on the body follows.
void settle_grip(const ContactStep& step, const SpringContact& solved, int point, Grip& grip) {
  const Spring& spring = solved.spring;
  const SpringResponse& response = solved.response;
  const Vector3 force = vector(response.force);
  if (point == 0) {
    grip.force.setZero();
    grip.torque.setZero();
    grip.slips = false;
  }
  grip.force += force;
  grip.torque += vector(solved.arm).cross(force);
  if (response.trial_squared <= spring.slip_limit * spring.slip_limit) return;
  grip.slips = true;
  // Ideal plasticity: the anchor follows by the motion that the limit force does not take up. As in slide(),
  // with phi = mu: s + h u - s(h) = (h / e) (q+ - F / k).
  const double followed = step.step / spring.ahead;
  const Vector3 yielded = followed * (vector(response.drawn) - force / spring.shear);
  const Pose& pose = step.bodies[grip.body].pose;
  Vector3& end = grip.in_body[point];
  end = pose.to_local(pose * end + yielded);
}

}  // namespace

void make_hand_rows(const ContactStep& step, const Island& island, std::vector<SpringContact>& rows) {
  std::size_t count = 0;
  for (const IslandBody& body : island.bodies) count += body.last - body.first;
  for (const Grip& grip : step.grips) count += grip.active ? kGripPoints : 0;
  rows.resize(count);
  SpringContact* row = rows.data();
  int number = 0;
  for (const IslandBody& body : island.bodies) {
    for (std::size_t i = body.first; i < body.last; ++i) {
      if (step.contacts[i].ignored) continue;
      row->a = SpringContact::kNone, row->b = number;
      make_spring(step, step.contacts[i], *row++);
    }
    ++number;
  }
  for (const Grip& grip : step.grips) {
    const int body = grip.active ? island.number_of(grip.body) : SpringContact::kNone;
    if (body < 0) continue;
    for (int point = 0; point < kGripPoints; ++point, ++row) {
      make_grip_spring(step, grip, point, *row);
      row->a = SpringContact::kNone, row->b = body;
    }
  }
  rows.resize(row - rows.data());
}

void make_link_row(const ContactStep& step, const Island& island, const BodyContact& contact,
                   SpringContact& row) {
  row.a = step.scene.bodies[contact.key.a].fixed ? SpringContact::kNone : island.number_of(contact.key.a);
  row.b = island.number_of(contact.key.b);
  make_spring(step, contact, row);
}

const SpringContact* settle_hand_rows(ContactStep& step, const Island& island, const SpringContact* row) {
  for (const IslandBody& body : island.bodies) {
    for (std::size_t i = body.first; i < body.last; ++i) {
      if (!step.contacts[i].ignored) settle(step, *row++, step.contacts[i]);
    }
  }
  for (Grip& grip : step.grips) {
    if (!grip.active || !island.contains(grip.body)) continue;
    for (int point = 0; point < kGripPoints; ++point) settle_grip(step, *row++, point, grip);
  }
  return row;
}

}  // namespace mrhi
