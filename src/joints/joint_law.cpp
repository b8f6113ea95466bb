#include "joint_law.h"

#include <algorithm>
#include <cmath>

#include "mr_hand_interaction/simulation_state.h"

namespace mrhi {
namespace {

/// Stiffness of limits, friction and latch, over the joint's inertia per squared step: a displacement of a
/// millimetre in a step becomes a tenth of a micrometre.
///
/// With K = 1e4 I / h^2 the Hessian I + h^2 K has 1e4 times the joint's own entry. The penalty scales with
/// step and inertia, not with the scene, so short steps and heavy doors do not worsen H's condition.
constexpr double kStopOverInertia = 1e4;

/// Stiffness of a detent's spring: it reaches the detent's force halfway to its nearest neighbour.
///
/// k_d = force / (gap / 2), with gap the smallest between neighbours. The spring pulls towards one position,
/// x_d. The force jumps from -force to force where the next detent takes over.
double detent_stiffness(const Detents& detents) {
  double min_spacing = detents.at.back() - detents.at.front();
  for (std::size_t i = 1; i < detents.at.size(); ++i)
    min_spacing = std::min(min_spacing, detents.at[i] - detents.at[i - 1]);
  return detents.force / (0.5 * min_spacing);
}

double detent_position(const Detents& detents, std::size_t index) {
  return detents.at[std::min(index, detents.at.size() - 1)];
}

/// Distances at which a joint arrives at a limit, and at which it has left it again [rad, m]. A joint that
/// loads its limit yields by the limit's compliance. With one threshold it would report arrival again and
/// again.
constexpr double kAtLimit = 1e-5, kOffLimit = 1e-3;

std::size_t nearest(const std::vector<double>& places, double to) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < places.size(); ++i) {
    if (std::abs(places[i] - to) < std::abs(places[best] - to)) best = i;
  }
  return best;
}

bool catches(const Latch& latch, double position) {
  return std::abs(position - latch.at) <= latch.reach;
}

}  // namespace

JointState start_state(const Joint& joint) {
  JointState state;
  state.position = state.anchor = joint.start;
  if (joint.detents) state.detent = static_cast<std::uint8_t>(nearest(joint.detents->at, joint.start));
  state.latched = joint.latch && catches(*joint.latch, joint.start);
  if (joint.upper - joint.start <= kAtLimit) state.at_limit = 1;
  if (joint.start - joint.lower <= kAtLimit) state.at_limit = -1;
  return state;
}

//     q' = s.(v_child - v_parent - w_parent x (c_child - c_parent)) + a.(w_child - w_parent)
//
// with (s, a) the joint's unit twist in world axes, fixed in the parent; one of them is 0. The state is the
// bodies' momenta, so a joint's velocity follows from them.
double joint_velocity(const Scene& scene, std::size_t index, const std::vector<BodyState>& bodies) {
  const Joint& joint = scene.joints[index];
  const auto motion = [&](int body) {
    return body == Joint::kWorld ? Twist() : twist_of(scene.bodies[body], bodies[body]);
  };
  const auto pose = [&](int body) { return body == Joint::kWorld ? Pose() : bodies[body].pose; };
  const Twist unit = unit_twist(joint, pose(joint.parent).orientation * joint.in_parent.orientation);
  const Twist parent = motion(joint.parent), own = motion(joint.child);
  const Vector3 arm = pose(joint.child).position - pose(joint.parent).position;
  const Vector3 linear = own.linear - (parent.linear + parent.angular.cross(arm));
  return unit.linear.dot(linear) + unit.angular.dot(own.angular - parent.angular);
}

// Uses the position after the flight: a position passed and left within a step is not reported.
JointChange note_place(const Joint& joint, JointState& state) {
  JointChange change;
  const double below = joint.upper - state.position, above = state.position - joint.lower;
  const std::int8_t at = above <= kAtLimit ? -1 : below <= kAtLimit ? 1 : 0;
  change.reached_limit = at != 0 && at != state.at_limit;
  if (at != 0 || std::min(above, below) > kOffLimit) state.at_limit = at;
  if (joint.detents) {
    const auto now = static_cast<std::uint8_t>(nearest(joint.detents->at, state.position));
    change.entered_detent = now != state.detent;
    state.detent = now;
  }
  if (!joint.latch) return change;
  const bool latched = catches(*joint.latch, state.position);
  change.opened_latch = state.latched && !latched;
  state.latched = latched;
  return change;
}

//     F = clamp(K (s - h v), -+most),     -dF/d(h v) = K within it, 0 at it
//
// s is the anchor's distance. The spring with a force limit is dry friction like a god object's: it sticks to
// an anchor, where a law of sign(v) would creep or chatter at rest.
double JointLaw::YieldingSpring::force(double travel) const {
  return std::clamp(elastic_force(travel), -max_force, max_force);
}
double JointLaw::YieldingSpring::slope(double travel) const {
  return std::abs(elastic_force(travel)) < max_force ? stiffness : 0.0;
}
// Potential of a spring that slips at `max_force`: a parabola, continued by a straight line (Huber's
// function). E(q) = K q^2 / 2 up to F_max / K, and F_max (q - F_max / 2K) beyond; dE/d(h v) = -F.
double JointLaw::YieldingSpring::energy(double travel) const {
  if (stiffness <= 0.0) return 0.0;
  const double size = std::abs(elastic_force(travel));
  return (size < max_force ? 0.5 * size * size : max_force * (size - 0.5 * max_force)) / stiffness;
}
// Distance of x+ beyond the limit: max(0, +-h v - clearance). K times this pushes the joint back, and never
// pulls.
double JointLaw::LimitSpring::penetration(double travel) const {
  return std::max(0.0, sign * travel - clearance);
}

// With x the position, v the velocity at the end of the step and x+ = x + h v:
//
//     t(v) = k (rest - x+) + k_d (detent - x+) - b v + clamp(K (anchor - x+), -+friction)
//            + clamp(K (latch - x+), -+force) + K (how far x+ is below the lower limit, or above the upper
//            one)
//
// Each term is evaluated at the end of the step, as contacts are: k and K add h k and h K to the slope, so no
// stiffness requires a shorter step. K = kStopOverInertia * inertia / h^2.
//
// Of an existing violation of a limit, a step corrects only the fraction h / h_regular, at a rate as
// Baumgarte's (1972) method does. Correcting all of it in a short step would cause the velocity depth / h.
// Detent and latch are those at the start of the step.
void JointLaw::begin(const Joint& joint, const JointState& state, double inertia, double step,
                     double regular_step) {
  step_ = step;
  limit_impulse_ = 0.0;
  constant_ = 0.0;
  linear_ = joint.damping;
  // k (to - x - h v)
  const auto spring = [&](double stiffness, double to) {
    constant_ += stiffness * (to - state.position);
    linear_ += stiffness * step;
  };
  if (joint.spring) spring(joint.spring->stiffness, joint.spring->rest);
  if (joint.detents) spring(detent_stiffness(*joint.detents), detent_position(*joint.detents, state.detent));
  stop_ = kStopOverInertia * inertia / (step * step);
  friction_ = latch_ = {};
  if (joint.friction > 0.0) friction_ = {stop_, state.anchor - state.position, joint.friction};
  if (joint.latch && state.latched) latch_ = {stop_, joint.latch->at - state.position, joint.latch->force};
  const auto corrected = [part = std::min(1.0, step / regular_step)](double left) {
    return left < 0.0 ? part * left : left;
  };
  lower_ = {corrected(state.position - joint.lower), -1.0};
  upper_ = {corrected(joint.upper - state.position), 1.0};
}

// If false, the flight advances the joint without forces. A limit counts within twice the step's motion.
bool JointLaw::acts(double speed) const {
  constexpr double kLimitMargin = 1e-6;
  const double threshold = 2.0 * step_ * speed + kLimitMargin;
  return linear_ > 0.0 || constant_ != 0.0 || friction_.stiffness > 0.0 || latch_.stiffness > 0.0 ||
         lower_.clearance < threshold || upper_.clearance < threshold;
}

double JointLaw::force(double velocity) const {
  const double travel = step_ * velocity;
  return constant_ - linear_ * velocity + friction_.force(travel) + latch_.force(travel) +
         stop_ * (lower_.penetration(travel) - upper_.penetration(travel));
}

// -dt/dv = b + h (k + k_d) + h K for each hold that does not slip.
double JointLaw::slope(double velocity) const {
  const double travel = step_ * velocity;
  const double stops =
      (lower_.penetration(travel) > 0.0 ? stop_ : 0.0) + (upper_.penetration(travel) > 0.0 ? stop_ : 0.0);
  return linear_ + step_ * (friction_.slope(travel) + latch_.slope(travel) + stops);
}

// e(v) = (b + h k) v^2 / 2 - k (rest - x) v + (E_friction + E_latch + K over^2 / 2) / h. The last is a
// function of h v, so de/dv = -t.
double JointLaw::energy(double velocity) const {
  const double travel = step_ * velocity, lower = lower_.penetration(travel),
               upper = upper_.penetration(travel);
  const double held =
      friction_.energy(travel) + latch_.energy(travel) + 0.5 * stop_ * (lower * lower + upper * upper);
  return (0.5 * linear_ * velocity - constant_) * velocity + held / step_;
}

// Sums magnitudes: a spring and a stop may oppose each other, and errors are relative to both.
double JointLaw::size(double velocity) const {
  const double travel = step_ * velocity;
  return std::abs(constant_ - linear_ * velocity) + std::abs(friction_.force(travel)) +
         std::abs(latch_.force(travel)) + stop_ * (lower_.penetration(travel) + upper_.penetration(travel));
}

// effort = t(v) + limit impulse / h: mean of the joint's own forces over the step.
void JointLaw::settle(double velocity, JointState& state) const {
  const double travel = step_ * velocity;
  state.effort = force(velocity) + limit_impulse_ / step_;
  // The anchor of dry friction follows where the force is at its limit.
  if (friction_.stiffness > 0.0)
    state.anchor = state.position + travel + friction_.force(travel) / friction_.stiffness;
}

}  // namespace mrhi
