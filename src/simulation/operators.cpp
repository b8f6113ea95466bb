#include "operators.h"

#include <algorithm>
#include <cmath>

#include "../response/impact.h"
#include "../scene/limits.h"

namespace mrhi {
namespace {

static_assert(body_limits::kMaxOperators == kMaxHands, "at most one operator for each hand");

/// Largest departure of an operator's hands from their predicted path, at which neighbours are listed again
/// [m]. 100 N move 80 kg by 0.04 mm within a frame at 120 Hz.
constexpr double kMaxDeparture = 0.002;
/// Limit of that departure over a short frame's squared duration: far more than a person's strength gives 80
/// kg [m/s^2].
constexpr double kMaxDepartureRate = 20.0;
/// Largest distance of a hand from its operator's centre of mass in that bound [m].
constexpr double kMaxReach = 1.5;
/// Largest speed at which a tether retracts its excess length [m/s]: enough for what a swing stretches it by
/// in a step.
constexpr double kMaxRetraction = 0.1;

Hand placed(const Pose& frame, const Hand& hand) {
  const Matrix3 rotation = frame.orientation.toRotationMatrix();
  const auto place = [&](const Vector3& point) -> Vector3 { return rotation * point + frame.position; };
  Hand result = hand;
  result.palm = frame * hand.palm;
  result.wrist = place(hand.wrist);
  for (Capsule& capsule : result.capsules) {
    if (capsule.radius <= 0.0) continue;
    capsule.start = place(capsule.start);
    capsule.end = place(capsule.end);
  }
  return result;
}

}  // namespace

Operators::Operators(const Scene& scene)
    : scene_(scene),
      carriers_(scene.operators.size()),
      start_(scene.operators.size()),
      courses_(scene.operators.size()),
      carried_(scene.operators.size()),
      in_world_(scene.operators.empty() ? 0 : kMaxHands) {
  touched_.reserve(none() ? 0 : scene.bodies.size());
  bodies_of_hands_.fill(none() ? 0 : scene.operators.front().body);
  on_fixtures_.reserve(64 * kMaxHands);
}

Pose Operators::frame(const Operator& op, const SimulationState& state) const {
  const auto body = static_cast<std::size_t>(op.body);
  return state.bodies[body].pose * scene_.bodies[body].link_in_body;
}

Pose Operators::in_hands_frame(std::size_t slot, std::size_t body, const SimulationState& state) const {
  if (none()) return state.bodies[body].pose;
  const Operator& owner = scene_.operators[state.hands[slot].current.id % scene_.operators.size()];
  return frame(owner, state).inverse() * state.bodies[body].pose;
}

void Operators::end_frame(const SimulationState& state) {
  if (none()) return;
  begin_step(0.0, state);
  for (std::size_t slot = 0; slot < state.hands.size(); ++slot) {
    const HandTrack& track = state.hands[slot];
    if (!track.active) continue;
    HandTrack& placed_track = in_world_[slot];
    placed_track.active = track.active, placed_track.held = track.held;
    placed_track.appeared = track.appeared, placed_track.emerged = track.emerged;
    const auto o = static_cast<std::size_t>(owners_[slot]);
    placed_track.previous = placed(start_[o], track.previous);
    placed_track.current = placed(frame(scene_.operators[o], state), track.current);
  }
}

void Operators::begin_frame(double seconds, const SimulationState& state) {
  if (none()) return;
  for (std::size_t slot = 0; slot < state.hands.size(); ++slot) {
    const HandTrack& track = state.hands[slot];
    if (!track.active) continue;
    owners_[slot] = static_cast<int>(track.current.id % carriers_.size());
    bodies_of_hands_[slot] = scene_.operators[owners_[slot]].body;
  }
  begin_step(seconds, state);
  for (std::size_t o = 0; o < carriers_.size(); ++o) start_[o] = frame(scene_.operators[o], state);
  predict(seconds);
}

void Operators::predict(double seconds) {
  const double allowed = std::min(kMaxDeparture, kMaxDepartureRate * seconds * seconds);
  for (std::size_t o = 0; o < carriers_.size(); ++o) {
    courses_[o] = {carriers_[o].twist, 0.0, seconds, allowed};
    carried_[o] = {carriers_[o], seconds, allowed};
    carried_[o].motion.origin += 0.5 * seconds * carriers_[o].twist.linear;
  }
}

/// The departure of a hand's point from its prediction is at most the integral of |v - v0| + R |w - w0|, with
/// R its distance from the centre of mass.
bool Operators::begin_step(double left, const SimulationState& state) {
  bool on_course = true;
  for (std::size_t o = 0; o < carriers_.size(); ++o) {
    const auto index = static_cast<std::size_t>(scene_.operators[o].body);
    const Body& body = scene_.bodies[index];
    const BodyState& now = state.bodies[index];
    CarrierMotion& carrier = carriers_[o];
    const MovingBody moving(body, now, Vector3::Zero());
    carrier = {moving.rotation, moving.to_world(body.link_in_body.position), now.pose.position, moving.twist};
    Course& course = courses_[o];
    const double rate = (carrier.twist.linear - course.predicted.linear).norm() +
                        kMaxReach * (carrier.twist.angular - course.predicted.angular).norm();
    course.departed += rate * std::max(course.left - left, 0.0);
    course.left = left;
    on_course = on_course && course.departed + rate * left <= course.allowed;
  }
  return on_course;
}

//     n' K n,     K = 1/M - [r]x I^-1 [r]x     of the operator at the contact
// In an impact a hand moves its operator: the object meets the operator's effective mass.
void Operators::begin_contacts(SimulationState& state) {
  touched_.clear();
  touches_fixture_ = false;
  std::size_t noted = scene_.bodies.size();
  for (Contact& contact : state.contacts) {
    contact.carrier_inverse_mass = 0.0;
    if (contact.key.body != noted) note_momenta(noted = contact.key.body, state);
    if (contact.struck || contact.ignored) continue;
    const auto o = static_cast<std::size_t>(owners_[contact.key.hand]);
    const Body& body = scene_.bodies[scene_.operators[o].body];
    const Vector3 across =
        carriers_[o].rotation.transpose() * (contact.point - carriers_[o].centre).cross(contact.normal);
    contact.carrier_inverse_mass = 1.0 / body.mass + across.dot(body.inverse_inertia * across);
  }
  for (const Grip& grip : state.grips)
    if (grip.active) note_momenta(grip.body, state);
}

void Operators::note_momenta(std::size_t body, const SimulationState& state) {
  if (scene_.bodies[body].fixed) {
    touches_fixture_ = true;
    return;
  }
  for (const Touched& touched : touched_)
    if (touched.body == body) return;
  touched_.push_back({body, state.bodies[body].linear_momentum, state.bodies[body].angular_momentum});
}

// An object has the momentum p' = p + sum q after the step. Each impulse q has the arm r and, in a step with
// impacts, acts from the time t on. The flight and StepChanges::delay_impacts() give
//
//     x' = x + h p' / m - sum t q / m,      x' x p' + L' = x x p + L + sum (x + t p' / m + r) x q
//
// so q acts at x + r + t p' / m. Its opposite acts there on the operator, whose displacement h P' / M does
// not change its angular momentum about the origin. So both conserve their sum to rounding. If all t are 0
// and nothing else acts on the object, the sums are p' - p and x x (p' - p) + L' - L, whatever its contacts.
Twist Operators::react(const ContactStep& step, int body) const {
  Vector3 force = Vector3::Zero(), torque = Vector3::Zero();  // on objects, about the origin [N], [N m]
  Twist impulse;                                              // likewise [N s], [N m s]
  // Position of a point on an object at `time`, when an impulse begins to act there.
  const auto moved = [&](const Vector3& point, std::size_t object, double time) -> Vector3 {
    if (time <= 0.0 || !scene_.bodies[object].flies) return point;
    return point + time / scene_.bodies[object].mass * step.bodies[object].linear_momentum;
  };
  bool by_momentum = true;
  for (const Touched& touched : touched_) {
    by_momentum = by_momentum && reacts_by_momentum(step, touched.body);
    if (!by_momentum) break;
    const BodyState& now = step.bodies[touched.body];
    Vector3 change = now.linear_momentum - touched.linear_momentum;
    if (step.changes.solved(touched.body))
      change -= step.step * scene_.bodies[touched.body].mass * step.gravity;
    impulse.linear += change;
    impulse.angular += now.pose.position.cross(change) + now.angular_momentum - touched.angular_momentum;
  }
  const Vector3& centre = step.bodies[body].pose.position;
  if (by_momentum) return {-impulse.linear, centre.cross(impulse.linear) - impulse.angular};
  impulse = Twist();
  std::size_t last = scene_.bodies.size();
  bool fixed = false;
  double time = 0.0;
  for (const Contact& contact : step.contacts) {
    const std::size_t object = contact.key.body;
    if (object != last) {
      last = object;
      fixed = scene_.bodies[object].fixed;
      time = step.changes.mean_impact_time(object);
    }
    if (fixed || bodies_of_hands_[contact.key.hand] != body) continue;
    const Vector3 point = moved(contact.point, object, time);
    force += contact.force;
    torque += point.cross(contact.force) + contact.torque * contact.normal;
    if (contact.impulse.isZero(0.0)) continue;
    impulse.linear += contact.impulse;
    impulse.angular += moved(contact.point, object, contact.time_of_impact).cross(contact.impulse);
  }
  for (const Grip& grip : step.grips) {
    if (!grip.active || bodies_of_hands_[grip.hand] != body) continue;
    const Vector3 point =
        moved(step.bodies[grip.body].pose.position, grip.body, step.changes.mean_impact_time(grip.body));
    force += grip.force;
    torque += point.cross(grip.force) + grip.torque;
  }
  impulse.linear += step.step * force;
  impulse.angular += step.step * torque;
  return {-impulse.linear, centre.cross(impulse.linear) - impulse.angular};
}

void Operators::touch_fixtures(ContactStep& step, int body) {
  step.bodies[body].pushed = Twist();
  if (!touches_fixture_) return;
  on_fixtures_.clear();
  int owner = 0;
  for (Contact& contact : step.contacts) {
    const int o = owners_[contact.key.hand];
    if (contact.ignored || !scene_.bodies[contact.key.body].fixed || scene_.operators[o].body != body)
      continue;
    contact.force.setZero();
    contact.struck = contact.struck || contact.depth > 0.0;
    on_fixtures_.push_back(&contact);
    owner = o;
  }
  if (on_fixtures_.empty()) return;
  problem_.begin_operator(step, body, on_fixtures_, carriers_[owner].twist);
  if (!problem_.solve()) problem_.evaluate(true);  // the velocity has moved on since
  if (problem_.scale() <= 0.0) return;
  problem_.finish_operator(step, on_fixtures_);
  step.changes.mark_solved(body);
}

// The ends separate at u = d'(v + w x r) along the line d. An impulse j = (u - (l - x) / h) / d'K d, if
// positive, leaves them l apart at the step's end. It only removes energy, except for the turn of the line
// within a step.
void Operators::pull(ContactStep& step, const Tether& tether) const {
  const auto index = static_cast<std::size_t>(tether.body);
  const Body& body = scene_.bodies[index];
  BodyState& state = step.bodies[index];
  const Vector3 end = state.pose * tether.at;
  const Vector3 apart = end - step.bodies[tether.fixture].pose * tether.anchor;
  const double distance = apart.norm();
  if (distance <= 0.0) return;
  const Vector3 along = apart / distance, arm = end - state.pose.position;
  const Matrix3 inverse_inertia = world_inverse_inertia(body, state.pose.orientation);
  const Vector3 velocity =
      state.linear_momentum / body.mass + (inverse_inertia * state.angular_momentum).cross(arm);
  const double allowed = (tether.length - distance) / step.step, rate = along.dot(velocity);
  if (rate <= std::max(allowed, -kMaxRetraction)) return;
  const double mass = 1.0 / along.dot(collision_matrix(1.0 / body.mass, inverse_inertia, arm) * along);
  const Vector3 impulse = -mass * (rate - std::max(allowed, -kMaxRetraction)) * along;
  state.linear_momentum += impulse;
  state.angular_momentum += arm.cross(impulse);
}

void Operators::respond(ContactStep& step, const std::vector<char>& restrained) {
  for (std::size_t o = 0; o < scene_.operators.size(); ++o) {
    const int body = scene_.operators[o].body;
    BodyState& state = step.bodies[body];
    const Twist reaction = react(step, body);
    state.linear_momentum += reaction.linear;
    state.angular_momentum += reaction.angular;
    touch_fixtures(step, body);
    if (restrained[o] == 0) continue;
    state.linear_momentum.setZero();
    state.angular_momentum.setZero();
    step.changes.mark_solved(body);
  }
  for (const Tether& tether : scene_.tethers) pull(step, tether);
}

}  // namespace mrhi
