#include "spring_contact.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "penetration_force.h"
#include "side_by_side.h"

namespace mrhi {
namespace {

/// The contact's own damping, as the time by which a spring with a dashpot beside it (Kelvin-Voigt) looks
/// ahead. A step solved at its end damps as much as half the step does, so only the rest is added: a held
/// object comes to rest equally fast at every step length [s].
/// Backward Euler solves k (q + h q') at the step's end; about the step's middle, q + h/2 q', that is the
/// spring and a dashpot k h/2. With e = h + max(0, tau - h/2) in place of h the dashpot is k (e - h/2) = k
/// tau at every step up to 2 tau = 10 ms; beyond that the step alone damps more, and cannot be told to damp
/// less.
constexpr double kRelaxation = 0.005;

/// Lever at which the tangential springs of a fingertip's contact patch resist twisting about the normal [m].
constexpr double kTwistLever = 0.025;

/// Friction torque of a patch that presses evenly, over friction times push times its radius: the mean
/// distance of a disc's points from its middle.
/// T = integral of mu p r dA over a disc of radius a with p = N / (pi a^2), which is mu N (2 / a^2) a^3 / 3
/// = 2/3 mu N a. Hertz's pressure, which falls to the rim, would give 3 pi / 16 mu N a, an eighth less. The
/// radius is Hertz's a = sqrt(R d) (collision/god_object.cpp).
constexpr double kPatchTorque = 2.0 / 3.0;

/// Nothing is damped before it touches.
/// A gap is a spring of depth < 0 that closes at the step's end if h u.n < depth: with the dashpot's time
/// in place of h it would push on what only comes near.
template <typename Real>
Real look_ahead(double step, const Real& depth, bool damping) {
  return where_at_most(depth, constant<Real>(0.0), constant<Real>(step),
                       constant<Real>(mrhi::look_ahead(step, damping)));
}

double friction_of(const Material& material, Friction friction) {
  return friction == Friction::sticking ? material.static_friction : material.dynamic_friction;
}

/// With a hand; all on the same body.
/// The share is of the stiffness, so that N = k share d sums to what the phalanx bears, and of the
/// strength, but friction and patch are each point's own. Friction is that of the state before, mu or phi:
/// which one it is to be is found as the step is settled.
template <typename Each, typename Real>
void make_from(const ContactStep& step, const ContactConfiguration& configuration, const Contact& first,
               const Each& each, SpringContact<Real>& result) {
  const Material& material = step.scene.bodies[first.key.body].material;
  const Triple<Real> n = each(&Contact::normal), point = each(&Contact::point);
  const Triple<Real> reach = each(&Contact::hand_point) - point + each(&Contact::lever);
  Spring<Real>& spring = result.spring;
  spring.normal = n;
  // Eqs. 16 to 18: of p - c, with p brought back to the surface the way it came, what is along the surface.
  spring.stretch = reach - n.dot(reach) * n;
  spring.depth = each(&Contact::pressed);
  spring.twist = each(&Contact::twist);
  // Kelvin and Voigt's f = k (q + tau q') at the step's end: there q has grown by h q', so it is k (q + (h +
  // tau) q') with the q of now and the rate that is solved for. `ahead` is h + tau.
  spring.ahead = look_ahead<Real>(step.step, spring.depth, configuration.damping);
  spring.fade = constant<Real>(release_fade(configuration.release_fade));
  const HandStrength& hand = configuration.hand;
  spring.pad = constant<Real>(hand.pad);
  spring.half_over_pad = constant<Real>(hand.pad > 0.0 ? 0.5 / hand.pad : 0.0);
  spring.stiffness = constant<Real>(material.stiffness) * each(&Contact::share);
  // In metres of a spring at full stiffness; divided by no stiffness it would be no number in a lane that is
  // filled up.
  spring.yields = each(&Contact::strength) / greater(spring.stiffness, constant<Real>(1e-300));
  spring.bond = constant<Real>(0.0);
  // Springs k at a lever l: a turn by 1 rad stretches them by l, and they give k l at that lever.
  const double twisting = configuration.torsion ? kTwistLever * kTwistLever : 0.0;
  spring.twist_stiffness = spring.stiffness * constant<Real>(twisting);
  spring.friction =
      each([&](const Contact& contact) { return contact.grip * friction_of(material, contact.friction); });
  spring.patch_friction = constant<Real>(kPatchTorque) * spring.friction * each(&Contact::patch);
  result.arm = point - everywhere<Real>(step.bodies[first.key.body].pose.position);
  result.drive = each(&Contact::hand_velocity);
  result.drive_spin = each(&Contact::hand_spin);
}

/// Of bodies: the stretch is that of the anchors, along n is nothing to remember. No pad, no torsion: points
/// of a manifold share the load, and twist is what they bear together. Body a moves too: its velocity is the
/// solver's, not `drive`.
template <typename Each, typename Real>
void make_from(const ContactStep& step, const ContactConfiguration& configuration, const BodyContact&,
               const Each& each, SpringContact<Real>& result) {
  const Real zero = constant<Real>(0.0);
  Spring<Real>& spring = result.spring;
  spring.normal = each(&BodyContact::normal);
  spring.stretch = each(&BodyContact::stretch);
  spring.depth = each(&BodyContact::depth);
  spring.ahead = look_ahead<Real>(step.step, spring.depth, configuration.damping);
  spring.fade = constant<Real>(release_fade(configuration.release_fade));
  spring.stiffness = constant<Real>(configuration.object_stiffness) * each(&BodyContact::share);
  spring.friction =
      each([](const BodyContact& contact) { return friction_of(contact.material, contact.friction); });
  spring.twist = spring.twist_stiffness = spring.patch_friction = zero;
  spring.pad = spring.half_over_pad = spring.bond = zero;
  spring.yields = constant<Real>(HandStrength::kUnlimited);
  result.arm = each(&BodyContact::arm_b);
  result.drive = {zero, zero, zero};
  result.drive_spin = zero;
}

SpringContact<double> contact_in(int, const SpringContact<double>& only) {
  return only;
}

/// By how much the end on 2 has to follow along the surface where it slips: what the spring and its damping,
/// in line with the friction, do not.
/// The spring and its dashpot bear what friction leaves of them, k (s + e s') = F with |F| <= phi N: so the
/// stretch relaxes to F / k,
///
///     s(h) = s + (h / e) (F / k - s)          e = `ahead`, with s' = (s(h) - s) / h
///     slide = s + h u_t - s(h)                h u_t = (h / e) (q+ - s)
///
/// Without the dashpot, e = h, the end is dragged to where the spring has just F (Eq. 20, and the god
/// object of Zilles & Salisbury 1995). F itself is at the limit of the state before; where that was mu,
/// `rim` takes it back to phi N.
Vector3 slide(const SpringContact<double>& solved, double dynamic_friction, double step) {
  const Spring<double>& spring = solved.spring;
  const SpringResponse<double>& response = solved.response;
  // The ends part by h u = (h / ahead) (drawn - stretch). Spring and dashpot take up as much of it as the
  // force F at the rim stretches them by in h, (h / ahead) (F / k - stretch). The rest is slid.
  const double followed = step / spring.ahead;
  const Vector3 drawn = vector(response.drawn), stretch = vector(spring.stretch);
  const Vector3 tangential = vector(response.force + response.push * spring.normal);
  const double rim = std::min(1.0, dynamic_friction * response.push / tangential.norm());
  const Vector3 kept = stretch + followed * (rim * tangential / spring.stiffness - stretch);
  return stretch + followed * (drawn - stretch) - kept;
}

void follow(const ContactStep& step, const Vector3& slide, Contact& contact) {
  const Pose& pose = step.bodies[contact.key.body].pose;
  contact.god_object = pose.to_local(contact.point + slide - contact.lever);
}

void follow(const ContactStep& step, const Vector3& slide, BodyContact& contact) {
  const Pose& pose = step.bodies[contact.key.b].pose;
  contact.anchor_b = pose.to_local(pose * contact.anchor_b + slide);
}

/// Sliding speed up to which friction between objects stays static [m/s].
/// Friction falls from mu to phi as surfaces slide, not as the force of one point reaches its limit: the
/// corners of a block on a ramp bear unlike loads and yield one after the other before it slides, and a load
/// that dips for a moment after a landing starts no slide. What slides as slowly stops within 10 um. In long
/// steps it is what a step's fall makes.
constexpr double kStaticSpeed = 0.01;

/// Which friction a contact of bodies has that has yielded in this step: by the way that it slides with
/// static friction.
void settle_friction(const ContactStep& step, const SpringContact<double>& solved, BodyContact& touch) {
  const Vector3 way = slide(solved, touch.material.static_friction, step.step);
  const double speed = std::max(kStaticSpeed, step.step * step.gravity.norm());
  touch.friction = way.norm() > speed * step.step ? Friction::slipping : Friction::sticking;
}
void settle_friction(const ContactStep&, const SpringContact<double>&, Contact&) {}

double grip_of(const Contact& contact) {
  return contact.grip;
}
double grip_of(const BodyContact&) {
  return 1.0;
}
const Material& material_of(const ContactStep& step, const Contact& contact) {
  return step.scene.bodies[contact.key.body].material;
}
const Material& material_of(const ContactStep&, const BodyContact& contact) {
  return contact.material;
}

/// The turn that is left of the twist, as far as the torque holds it.
/// As in slide(): theta(h) = theta + (h / e) (T / k_t - theta), which is theta + h spin while T is within
/// its limit. A point that turns freely, k_t = 0, keeps what it has, and the quotient is not used.
template <typename Real>
Real kept_twist(const SpringContact<Real>& solved, double step) {
  const Spring<Real>& spring = solved.spring;
  const Real followed = constant<Real>(step) / spring.ahead;
  const Real kept =
      spring.twist + followed * (solved.response.torque / spring.twist_stiffness - spring.twist);
  return where_at_most(spring.twist_stiffness, constant<Real>(0.0), spring.twist, kept);
}
void keep_twist(double twist, Contact& contact) {
  contact.twist = twist;
}
void keep_twist(double, BodyContact&) {}
void keep_torque(double torque, Contact& contact) {
  contact.torque = torque;
}
void keep_torque(double, BodyContact&) {}

/// One contact of those that `solved` stands for.
///
///     sticks:     |k q+| <= mu N            from sticking
///                 |k q+| <= 0.9 phi N       from slipping
///
/// Friction of the step just solved had the limit of the state before: one that breaks away in this step
/// bore mu N, and bears phi N in the next one. An open contact, N = 0, has nothing to follow.
template <typename Stored, typename Touch>
void settle_lane(const ContactStep& step, const SpringContact<Stored>& solved, int lane, Touch& touch) {
  const auto of = [lane](const auto& value) { return lane_of(lane, value); };
  touch.force = vector(of(solved.response.force));
  // Eqs. 19, 20 with mu while it sticks and phi while it slides, by the push of the step's end.
  // What slips sticks again well within the limit only: at the limit it would change over in every step.
  const double limit =
      (touch.friction == Friction::sticking ? 1.0 : kStickAgain) * of(solved.spring.slip_limit);
  const bool sticks = of(solved.response.wanted_squared) <= limit * limit;
  touch.friction = sticks ? Friction::sticking : Friction::slipping;
  if (sticks || of(solved.response.push) <= 0.0) return;
  const SpringContact<double> one = contact_in(lane, solved);
  settle_friction(step, one, touch);
  const double friction = grip_of(touch) * friction_of(material_of(step, touch), touch.friction);
  follow(step, slide(one, friction, step.step), touch);
}

}  // namespace

SpringContact<double> contact_in(int lane, const SpringContact<Lanes>& four) {
  constexpr std::size_t kNumbers = sizeof(SpringContact<double>) / sizeof(double);
  // One struct of doubles is a column of the other's Lanes: the number i of one is the lane `lane` of the
  // i-th of four. That holds as long as both have the same members in the same order, all of them Real.
  static_assert(sizeof(four) == kNumbers * sizeof(Lanes), "the same members, each a number or four");
  SpringContact<double> result;
  for (std::size_t i = 0; i < kNumbers; ++i)
    reinterpret_cast<double*>(&result)[i] = reinterpret_cast<const Lanes*>(&four)[i].lane[lane];
  return result;
}

void put_in(int lane, const SpringContact<double>& one, SpringContact<Lanes>& four) {
  constexpr std::size_t kNumbers = sizeof(SpringContact<double>) / sizeof(double);
  for (std::size_t i = 0; i < kNumbers; ++i)
    reinterpret_cast<Lanes*>(&four)[i].lane[lane] = reinterpret_cast<const double*>(&one)[i];
}

// e = h + max(0, tau - h / 2): see kRelaxation.
double look_ahead(double step, bool damping) {
  return step + (damping ? std::max(0.0, kRelaxation - 0.5 * step) : 0.0);
}

template <typename Touch>
void make_spring(const ContactStep& step, const ContactConfiguration& configuration, const Touch& touch,
                 SpringContact<double>& result) {
  make_from(step, configuration, touch, One<Touch>(touch), result);
}

template <typename Touch>
void make_springs(const ContactStep& step, const ContactConfiguration& configuration, Touch* const* touches,
                  SpringContact<Lanes>& result) {
  make_from(step, configuration, *touches[0], Four<Touch>(touches), wide(result));
}

template <typename Touch>
void settle(const ContactStep& step, const SpringContact<double>& solved, Touch& touch) {
  keep_twist(kept_twist(solved, step.step), touch);
  keep_torque(solved.response.torque, touch);
  settle_lane(step, solved, 0, touch);
}

template <typename Touch>
void settle(const ContactStep& step, const SpringContact<Lanes>& solved, Touch* const* touches) {
  const Wide twist = kept_twist(wide(solved), step.step);
  for (int lane = 0; lane < kLanes; ++lane) {
    keep_twist(lane_of(lane, twist), *touches[lane]);
    keep_torque(lane_of(lane, solved.response.torque), *touches[lane]);
    settle_lane(step, solved, lane, *touches[lane]);
  }
}

template void make_spring(const ContactStep&, const ContactConfiguration&, const Contact&,
                          SpringContact<double>&);
template void make_springs(const ContactStep&, const ContactConfiguration&, Contact* const*,
                           SpringContact<Lanes>&);
template void settle(const ContactStep&, const SpringContact<double>&, Contact&);
template void settle(const ContactStep&, const SpringContact<Lanes>&, Contact* const*);
template void make_spring(const ContactStep&, const ContactConfiguration&, const BodyContact&,
                          SpringContact<double>&);
template void make_springs(const ContactStep&, const ContactConfiguration&, BodyContact* const*,
                           SpringContact<Lanes>&);
template void settle(const ContactStep&, const SpringContact<double>&, BodyContact&);
template void settle(const ContactStep&, const SpringContact<Lanes>&, BodyContact* const*);

namespace {

/// Integral of min(k q, limit) from 0 to q: energy of a spring that yields.
/// Huber's function:
///
///     E(q) = k q^2 / 2                k q <= L
///     E(q) = L q - L^2 / 2k           beyond: value L^2 / 2k and slope L meet at q = L / k
double yielding_energy(double stiffness, double stretch, double limit) {
  if (stiffness * stretch <= limit) return 0.5 * stiffness * stretch * stretch;
  return limit * stretch - 0.5 * limit * limit / stiffness;
}

/// Gauss and Legendre's rule of three points, exact for polynomials up to degree five.
/// The push is a polynomial of the fourth degree between its kinks: p of the second degree in the depth,
/// which is linear in the rate, times 1 - r^2.
template <typename Function>
double integral(double from, double to, Function function) {
  const double middle = 0.5 * (from + to), half = 0.5 * (to - from), off = std::sqrt(0.6) * half;
  return half / 9.0 * (5.0 * function(middle - off) + 8.0 * function(middle) + 5.0 * function(middle + off));
}

// N(v) as in Spring::respond().
double push(const Spring<double>& spring, double rate) {
  const double deep = std::max(0.0, spring.depth - spring.ahead * rate);
  const double parting = std::min(std::max(rate, 0.0) * spring.fade, 1.0);
  double pressed, steepness;
  spring.press(deep, pressed, steepness);
  return spring.stiffness * pressed * (1.0 - parting * parting);
}

/// Depth at which the spring begins to give way.
/// Spring::press() solved for p(d) = Y: d = Y + D / 2 beyond the pad, where p >= D / 2, and d = sqrt(2 Y D)
/// within it.
double yielding_depth(const Spring<double>& spring) {
  if (spring.yields >= 0.5 * spring.pad) return spring.yields + 0.5 * spring.pad;
  return std::sqrt(2.0 * spring.yields * spring.pad);
}

/// Integral of the push from the rate up, until it is none any more: piece by piece, a polynomial each.
///
///     E_N(v) = integral of N(x) dx from v on,     dE_N/dv = -N(v)
///
/// Kinks are where the finger begins to give way, where the pad ends, at rest, from where on the fade acts,
/// and where the push ends: at d+ = 0 or at the release speed, whichever is slower.
double push_energy(const Spring<double>& spring, double rate) {
  const auto rate_at = [&](double depth) { return (spring.depth - depth) / spring.ahead; };
  const double end = spring.fade > 0.0 ? std::min(rate_at(0.0), 1.0 / spring.fade) : rate_at(0.0);
  std::array<double, 4> kinks{rate_at(yielding_depth(spring)), rate_at(spring.pad), 0.0, end};
  std::sort(kinks.begin(), kinks.end());
  double energy = 0.0, from = rate;
  for (const double kink : kinks) {
    const double to = std::min(kink, end);
    if (to <= from) continue;
    energy += integral(from, to, [&](double x) { return push(spring, x); });
    from = to;
  }
  return energy;
}

}  // namespace

// V(u) = E_N(v) + (E_F(|q+|) + E_T(|theta+|)) / tau, E_N the integral of N from v on, E_F and E_T those of a
// spring that yields at L and L_t (Huber's function). d/du of E_F / tau is F, since q+ grows by tau P u.
// Minus its gradient is the force. With Coulomb's limits held it is convex, since each force falls as its own
// rate grows; so the step has one solution, and a line search along Newton's direction finds it.
// In watts: a force times a velocity, the rate form of an incremental potential (Kane et al. 2000). It is
// an energy over the time tau.
double potential(const Spring<double>& spring, const Triple<double>& u, double spin) {
  const double rate = u.dot(spring.normal);
  const Triple<double> drawn = spring.stretch + spring.ahead * (u - rate * spring.normal);
  const double turned = std::abs(spring.twist + spring.ahead * spin);
  return push_energy(spring, rate) +
         (yielding_energy(spring.stiffness, std::sqrt(drawn.dot(drawn)), spring.slip_limit) +
          yielding_energy(spring.twist_stiffness, turned, spring.twist_limit)) /
             spring.ahead;
}

// With no normal and no depth the spring acts in all directions, and what it bears is the bond alone: a
// Coulomb contact whose limit does not hang on a push.
//
//     F = k q+ min(1, bond / k|q+|)       q+ = s + tau u, all of u: n = 0 makes P the identity
//
// Depth and fade are 0, so N is 0. The four are at corners of a tetrahedron: forces alone, they bear
// torques about any axis.
void make_grip_spring(const ContactStep& step, const ContactConfiguration& configuration, const Grip& grip,
                      int point, SpringContact<double>& result) {
  const auto i = static_cast<std::size_t>(point);
  const Pose& pose = step.bodies[grip.body].pose;
  const Vector3 on_body = pose * grip.in_body[i];
  result = SpringContact<double>();
  result.spring.stretch = triple(grip.point[i] - on_body);
  result.spring.ahead = look_ahead(step.step, configuration.damping);
  result.spring.stiffness = grip.stiffness;
  result.spring.yields = HandStrength::kUnlimited;
  result.spring.bond = grip.bond;
  result.arm = triple(on_body - pose.position);
  result.drive = triple(grip.velocity[i]);
}

void settle_grip(const ContactStep& step, const SpringContact<double>& solved, int point, Grip& grip) {
  const Spring<double>& spring = solved.spring;
  const SpringResponse<double>& response = solved.response;
  const Vector3 force = vector(response.force);
  if (point == 0) {
    grip.force.setZero();
    grip.torque.setZero();
    grip.slips = false;
  }
  grip.force += force;
  grip.torque += vector(solved.arm).cross(force);
  if (response.wanted_squared <= spring.slip_limit * spring.slip_limit) return;
  grip.slips = true;
  // Ideal plasticity: the end on the body goes after by what the force at the limit does not stretch, as far
  // as the step goes of the time that the spring looks ahead.
  // As in slide(), with phi = mu: s + h u - s(h) = (h / e) (q+ - F / k).
  const double followed = step.step / spring.ahead;
  const Vector3 yielded = followed * (vector(response.drawn) - force / spring.stiffness);
  const Pose& pose = step.bodies[grip.body].pose;
  Vector3& end = grip.in_body[static_cast<std::size_t>(point)];
  end = pose.to_local(pose * end + yielded);
}

}  // namespace mrhi
