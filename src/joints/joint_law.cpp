#include "joint_law.h"

#include <algorithm>
#include <cmath>

#include "mr_hand_interaction/simulation_state.h"

namespace mrhi {
namespace {

/// Ratio of a stop's stiffness to the joint's inertia over the squared step: a force that would move the
/// joint by a millimetre in a step moves it by a tenth of a micrometre. With K = 1e4 I / h^2 the Hessian I +
/// h^2 K has 1e4 times the joint's own entry. The penalty scales with step and inertia, so that the condition
/// of the Hessian is the same for short steps and heavy doors.
constexpr double kStopStiffnessRatio = 1e4;

/// A detent yields half-way to its nearest neighbour, where its spring has the nominal force.
/// k_d = force / (gap / 2), gap the least between neighbours: the spring draws to one place, x_d, and there
/// is a jump from -force to force where the next one's takes over.
double detent_stiffness(const Detents& detents) {
  double least = detents.at.back() - detents.at.front();
  for (std::size_t i = 1; i < detents.at.size(); ++i)
    least = std::min(least, detents.at[i] - detents.at[i - 1]);
  return detents.force / (0.5 * least);
}

double place_of(const Detents& detents, std::size_t index) {
  return detents.at[std::min(index, detents.at.size() - 1)];
}

/// Distances from a limit at which a joint arrives at it, and leaves it [rad, m]. Two thresholds, because a
/// loaded joint moves by the compliance of its stop: with one it would be reported to arrive again and again.
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

//     turns:   q' = a.(w_child - w_parent)
//     slides:  q' = a.(v_child - v_parent - w_parent x (c_child - c_parent))
//
// a = the joint's axis in world, fixed in the parent. Bodies' momenta are the state, so a joint's velocity
// is read from them.
double joint_velocity(const Scene& scene, std::size_t index, const std::vector<BodyState>& bodies) {
  const Joint& joint = scene.joints[index];
  const auto motion = [&](int body) {
    const auto b = static_cast<std::size_t>(body);
    return body == Joint::kWorld ? Twist() : twist_of(scene.bodies[b], bodies[b]);
  };
  const auto pose = [&](int body) {
    return body == Joint::kWorld ? Pose() : bodies[static_cast<std::size_t>(body)].pose;
  };
  const Pose frame = pose(joint.parent) * joint.in_parent, child = pose(joint.child);
  const Vector3 axis = frame.orientation * joint.axis;
  const Twist parent = motion(joint.parent), own = motion(joint.child);
  if (joint.kind == JointKind::turning) return axis.dot(own.angular - parent.angular);
  const Vector3 carried = parent.linear + parent.angular.cross(child.position - pose(joint.parent).position);
  return axis.dot(own.linear - carried);
}

// Uses only the position after the flight: a joint that passes a position and returns within the step is not
// reported.
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
// s is the anchor's distance. The spring that slips is dry friction as a god object's: it sticks to an
// anchor, where a law of sign(v) would creep or chatter at rest.
double JointLaw::Hold::force(double way) const {
  return std::clamp(wanted(way), -most, most);
}
double JointLaw::Hold::slope(double way) const {
  return std::abs(wanted(way)) < most ? stiffness : 0.0;
}
// A spring that slips at `most`: a parabola, and a straight line from there on (Huber's function).
// E(q) = K q^2 / 2 up to most / K, and most (q - most / 2K) beyond; dE/d(h v) = -F.
double JointLaw::Hold::energy(double way) const {
  if (stiffness <= 0.0) return 0.0;
  const double size = std::abs(wanted(way));
  return (size < most ? 0.5 * size * size : most * (size - 0.5 * most)) / stiffness;
}
// Distance of x+ beyond the limit: max(0, +-h v - room). K times it pushes back, and never pulls.
double JointLaw::Stop::over(double way) const {
  return std::max(0.0, sign * way - room);
}

// With x the place, v the velocity at the step's end and x+ = x + h v:
//
//     t(v) = k (rest - x+) + k_d (detent - x+) - b v + clamp(K (anchor - x+), -+friction)
//            + clamp(K (latch - x+), -+force) + K (how far x+ is below the lower limit, or above the upper
//            one)
//
// each term at the step's end, as contacts are: k and K add h k and h K to the slope, so that no stiffness
// asks for a shorter step. K = kStopStiffnessRatio * inertia / h^2.
// Only the fraction h / h_usual of an existing violation is corrected in a step (Baumgarte 1972): correcting
// all of it within a short step would be a velocity of depth / h. The detent and the latch are those of the
// step's start.
void JointLaw::begin(const Joint& joint, const JointState& state, double inertia, double step, double usual) {
  step_ = step;
  blow_ = 0.0;
  constant_ = 0.0;
  linear_ = joint.damping;
  // At the step's end, as contacts are: k (to - x - h v).
  const auto spring = [&](double stiffness, double to) {
    constant_ += stiffness * (to - state.position);
    linear_ += stiffness * step;
  };
  if (joint.spring) spring(joint.spring->stiffness, joint.spring->rest);
  if (joint.detents) spring(detent_stiffness(*joint.detents), place_of(*joint.detents, state.detent));
  stop_ = kStopStiffnessRatio * inertia / (step * step);
  friction_ = latch_ = {};
  if (joint.friction > 0.0) friction_ = {stop_, state.anchor - state.position, joint.friction};
  if (joint.latch && state.latched) latch_ = {stop_, joint.latch->at - state.position, joint.latch->force};
  // A joint beyond its limit returns as fast as in a usual step: within a far shorter one it would be thrown.
  const auto room = [part = std::min(1.0, step / usual)](double left) {
    return left < 0.0 ? part * left : left;
  };
  lower_ = {room(state.position - joint.lower), -1.0};
  upper_ = {room(joint.upper - state.position), 1.0};
}

// A joint on which nothing acts is left to ballistic flight. A limit counts within twice a step's
// displacement.
bool JointLaw::acts(double speed) const {
  constexpr double kNear = 1e-6;
  const double near = 2.0 * step_ * speed + kNear;
  return linear_ > 0.0 || constant_ != 0.0 || friction_.stiffness > 0.0 || latch_.stiffness > 0.0 ||
         lower_.room < near || upper_.room < near;
}

double JointLaw::force(double velocity) const {
  const double way = step_ * velocity;
  return constant_ - linear_ * velocity + friction_.force(way) + latch_.force(way) +
         stop_ * (lower_.over(way) - upper_.over(way));
}

// -dt/dv = b + h (k + k_d) + h K for each that holds and does not slip.
double JointLaw::slope(double velocity) const {
  const double way = step_ * velocity;
  const double stops = (lower_.over(way) > 0.0 ? stop_ : 0.0) + (upper_.over(way) > 0.0 ? stop_ : 0.0);
  return linear_ + step_ * (friction_.slope(way) + latch_.slope(way) + stops);
}

// e(v) = (b + h k) v^2 / 2 - k (rest - x) v + (E_friction + E_latch + K over^2 / 2) / h; the last by h v,
// so that de/dv = -t.
double JointLaw::energy(double velocity) const {
  const double way = step_ * velocity, lower = lower_.over(way), upper = upper_.over(way);
  const double held =
      friction_.energy(way) + latch_.energy(way) + 0.5 * stop_ * (lower * lower + upper * upper);
  return (0.5 * linear_ * velocity - constant_) * velocity + held / step_;
}

// Sums magnitudes, because errors are relative to all forces that act, also those that cancel.
double JointLaw::size(double velocity) const {
  const double way = step_ * velocity;
  return std::abs(constant_ - linear_ * velocity) + std::abs(friction_.force(way)) +
         std::abs(latch_.force(way)) + stop_ * (lower_.over(way) + upper_.over(way));
}

// effort = t(v) + blow / h: what the joint's own forces gave in the mean over the step.
void JointLaw::settle(double velocity, JointState& state) const {
  const double way = step_ * velocity;
  state.effort = force(velocity) + blow_ / step_;
  // Dry friction holds by a spring to an anchor, which follows where the force at the limit holds it no more.
  if (friction_.stiffness > 0.0)
    state.anchor = state.position + way + friction_.force(way) / friction_.stiffness;
}

}  // namespace mrhi
