#include "floating_person.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "../math/minimum_jerk.h"
#include "../math/rotation.h"

namespace mrhi {
namespace {

constexpr double kRailGripOffset = 0.34;    // of each hand on a rail from the body's middle [m]
constexpr double kApproachDistance = 0.08;  // from where a hand goes straight to what it takes [m]
constexpr double kArmLength = 0.8;          // [m] places farther away are out of reach
constexpr double kPalmGap = 0.004;          // of the palm before the fingers close [m]
constexpr double kReachBits = 4.2;          // of Fitts' law: a reach of kRailGripOffset to a hold of 2 cm
constexpr double kApproachTime = 0.4, kCloseTime = 0.4, kGripTime = 0.5, kOpenTime = 0.25, kRetreatTime = 0.4,
                 kSidestepTime = 0.7;  // times at pace 1 [s]

constexpr double kGlideSpeed = 0.15;                   // speed along a rail [m/s]; people go 0.1 to 0.3 m/s
constexpr double kPullDistance = 0.25;                 // of a pull from rest to that speed [m]
constexpr double kBrakeDistance = 0.2;                 // of the hands from that speed to rest [m]
constexpr double kMaxStroke = 0.3;                     // of the body from rest to rest without letting go [m]
constexpr double kStopTime = 2.5;                      // duration of a stop without a place [s]
constexpr int kMaxStops = 3;                           // before hands take the rail again
constexpr double kSettleTime = 0.5;                    // before the next look at what hands hold [s]
constexpr double kPlaceTolerance = 0.03;               // distance from a place that is left as it is [m]
constexpr double kMaxDeviation = 0.4;                  // of the body from its predicted path [m]
constexpr double kRestSpeed = 0.01, kRestSpin = 0.03;  // of a body at rest [m/s], [rad/s]

constexpr double kCarrySpeed = 0.05;       // mean speed of a heavy object in two hands [m/s]
constexpr double kCarryTolerance = 0.025;  // of a carried object from its place [m]
constexpr double kReleaseWait = 3.0;       // for what was put in its place [s]
constexpr double kThrowSpeed = 0.8;        // speed of a throw [m/s]
constexpr double kThrowStroke = 0.25;      // of the hand before it opens [m]
constexpr double kReleaseTime = 0.3;       // duration of the opening [s]
constexpr double kMaxWorkOffset = 0.25, kMaxWorkTilt = 0.4;  // of the body from where it works [m], [rad]
// Without a hold, practised motions are done in this fraction of their time: a shorter push drives the body
// away less, as a latch resists with the same force at any speed.
constexpr double kFreeTimeFraction = 0.5;
constexpr double kFreeWorkTime = 2.0;           // what such a push takes [s]
const Vector3 kHatchPosition(0.0, 0.15, 0.25);  // of the hatch's wall in its shipped scene

}  // namespace

FloatingPerson::FloatingPerson(const OperatorSkill& skill, std::vector<FloatingGoal> goals,
                               const Scene& surroundings, const Body& object, std::uint64_t seed)
    : Person(skill, seed), goals_(std::move(goals)), object_(object), right_tremor_(skill.tremor, random_) {
  if (surroundings.operators.empty())
    throw std::invalid_argument(
        "a simulated operator does a goal 'rest' only afloat: the task's scene has no " +
        std::string("operator; allowed: a scene with 'operator' in its YAML file"));
  const Body& person = surroundings.bodies.at(surroundings.operators.front().body);
  link_in_body_ = person.link_in_body;
  mass_ = person.mass;
  inertia_ = person.inertia;
  rails_ = rails_of(surroundings);
  const auto brings = std::find_if(goals_.begin(), goals_.end(), [](const FloatingGoal& goal) {
    return goal.kind == FloatingGoal::Kind::bring;
  });
  if (brings != goals_.end()) holds_ = holds_of(object, *brings->place);
  for (std::size_t hand = 0; hand < kHands; ++hand) {
    arms_[hand].now = shown_[hand] = {rest_pose(hand), relaxed_posture()};
    begin(0.0, hand, Frame::body);
  }
}

Pose FloatingPerson::rest_pose(std::size_t hand) const {
  const Pose right = hand_pose({0.22, -0.12, 0.1}, Vector3::UnitY(), Vector3::UnitZ());
  return hand == kLeft ? mirrored(right) : right;
}

Pose FloatingPerson::BodyPath::at(double time) const {
  const double since = time - began, share = since / duration, beyond = std::max(0.0, since - duration);
  const Vector3 still = Vector3::Zero();
  const Vector3 moved = minimum_jerk(still, begins.linear, travel.linear, ends.linear, duration, share),
                turned = minimum_jerk(still, begins.angular, travel.angular, ends.angular, duration, share);
  return {from.position + moved + beyond * ends.linear,
          (rotation_by(turned + beyond * ends.angular) * from.orientation).normalized()};
}

/// The frame in which hands are tracked.
Pose FloatingPerson::frame(double time, Frame of) const {
  if (of == Frame::body) return {};
  Pose body = path_.at(time);
  if (of == Frame::seen) {
    body.position += deviation_.linear;
    body.orientation = (rotation_by(deviation_.angular) * body.orientation).normalized();
  }
  return body * link_in_body_;
}

/// Pose of the body at `time` by what was seen a reaction time ago, if nothing holds it.
Pose FloatingPerson::expected_body(double time) const {
  const Moment& seen = past_.front();
  return expected(seen.sight.body, seen.sight.body_twist, time - seen.time);
}

/// Critically damped, so that a drift leaves no error.
void FloatingPerson::correct(double since) {
  const Moment& seen = past_.front();
  if (seen.time < path_.began) return;
  const Pose predicted = path_.at(seen.time);
  const Vector3 linear = seen.sight.body.position - predicted.position,
                angular = rotation_vector(seen.sight.body.orientation * predicted.orientation.conjugate());
  const Twist error{linear - deviation_.linear, angular - deviation_.angular};
  if (error.linear.norm() > kMaxDeviation) return lose(seen.time + skill_.reaction_time);
  deviation_.linear += since * (kCorrectionRate * error.linear + deviation_rate_.linear);
  deviation_.angular += since * (kCorrectionRate * error.angular + deviation_rate_.angular);
  deviation_rate_.linear += 0.25 * kCorrectionRate * kCorrectionRate * since * error.linear;
  deviation_rate_.angular += 0.25 * kCorrectionRate * kCorrectionRate * since * error.angular;
}

/// The body is elsewhere than predicted: lets go of everything.
void FloatingPerson::lose(double time) {
  for (Arm& arm : arms_) arm.on_rail = false;
  in_hand_ = false;
  rest_hands(time);
  drift(time);
  busy_until_ = time + paced(kSidestepTime);
}

/// From what is seen. Hands stay where they are.
void FloatingPerson::set_path(double time, double duration, const Twist& travel, const Twist& ends) {
  path_ = {time, duration, expected_body(time), past_.front().sight.body_twist, travel, ends};
  deviation_ = deviation_rate_ = Twist();
  for (std::size_t hand = 0; hand < kHands; ++hand)
    if (arms_[hand].frame != Frame::body) begin(time, hand, arms_[hand].frame);
}

/// The path of a body that nothing holds.
void FloatingPerson::drift(double time) {
  const Twist& twist = past_.front().sight.body_twist;
  set_path(time, 1.0, twist, twist);
}

HandPlace FloatingPerson::move(double time, const Sight& sight) {
  const bool begins = past_.empty();
  const bool has_seen = remember({time, sight});
  if (begins) {
    start_ = sight.body;
    drift(time);
  }
  correct(time - last_time_);
  last_time_ = time;
  if (time >= busy_until_ && has_seen) decide(time);
  for (std::size_t hand = 0; hand < kHands; ++hand) {
    Arm& arm = arms_[hand];
    arm.now = hand_at(arm.keyframes, time - arm.began);
    if (arm.frame != Frame::body) arm.now.wrist = frame(time, arm.frame).inverse() * arm.now.wrist;
    shown_[hand] = arm.now;
    shown_[hand].wrist.position += (hand == kLeft ? tremor_ : right_tremor_).at(time);
  }
  return shown_[kRight];
}

void FloatingPerson::decide(double time) {
  const std::size_t index = past_.front().sight.goal;
  if (index >= goals_.size()) return;
  const FloatingGoal& goal = goals_[index];
  switch (goal.kind) {
    case FloatingGoal::Kind::bring:
      return bring(time, goal);
    case FloatingGoal::Kind::rest:
      come_to_rest(time, goal.place);
      return;
    case FloatingGoal::Kind::work:
      return work(time, goal);
  }
}

// ---- The body along rails.

/// Returns whether the body rests.
bool FloatingPerson::come_to_rest(double time, const std::optional<Vector3>& place) {
  const Sight& sight = past_.front().sight;
  const Twist& twist = sight.body_twist;
  const Vector3 at = expected_body(time).position;
  const bool still = twist.linear.norm() < kRestSpeed && twist.angular.norm() < kRestSpin;
  const Vector3 off = place ? Vector3(*place - at) : Vector3::Zero();
  const Vector3 reached = at + sight.body.orientation * link_in_body_.position;
  const Rail& rail = nearest_rail(reached);
  const Vector3& axis = rail.axis;
  const double along = axis.dot(off), speed = twist.linear.norm();
  if (still && off.norm() < kPlaceTolerance) return true;
  if (rail.distance(reached) > kArmLength) {
    rest_hands(time);
    return false;
  }
  const Vector3 ahead =
      std::abs(along) < kPlaceTolerance ? Vector3::Zero() : Vector3(std::copysign(1.0, along) * axis);
  if (!arms_[kLeft].on_rail || !arms_[kRight].on_rail) {
    const double nearing = ahead.dot(twist.linear);
    const double wait =
        nearing > kRestSpeed ? (std::abs(along) - kBrakeDistance) / nearing - take_time() : 0.0;
    stops_ = 0;
    if (wait > 0.0) {
      busy_until_ = time + wait;
      rest_hands(time);
    } else {
      take_rail(time, arms_[kLeft].on_rail ? kRight : kLeft, arms_[kRight].on_rail ? kLeft : kRight,
                std::min(0.5 * std::abs(along), 0.5 * kPullDistance) * ahead);
    }
  } else if (++stops_ > kMaxStops) {
    release(0.0);  // a hand has missed its rail
  } else if (std::abs(along) > kMaxStroke) {
    glide_along(time, at, ahead);
  } else if (place) {
    follow(time, *place, Vector3::Zero(),
           speed > kRestSpeed ? kStopTime : std::max(kStopTime, std::abs(along) / (0.5 * kGlideSpeed)));
    busy_until_ += kSettleTime + skill_.reaction_time;
  } else {
    stop(time);
  }
  return false;
}

/// Pulls until the body glides, and lets go.
void FloatingPerson::glide_along(double time, const Vector3& at, const Vector3& ahead) {
  const double duration = 2.0 * kPullDistance / kGlideSpeed;
  follow(time, at + kPullDistance * ahead, kGlideSpeed * ahead, duration);
  release(duration);
}

/// Hands that hold a rail take the body along a path from its present motion, upright in the end.
void FloatingPerson::follow(double time, const Vector3& to, const Vector3& velocity, double duration) {
  const Pose from = expected_body(time);
  set_path(time, duration, {to - from.position, rotation_vector(from.orientation.conjugate())},
           {velocity, Vector3::Zero()});
  busy_until_ = time + duration;
}

/// The same to rest, as soon as that goes smoothly.
void FloatingPerson::stop(double time) {
  const Twist& twist = past_.front().sight.body_twist;
  set_path(time, kStopTime, {0.5 * kStopTime * twist.linear, 0.5 * kStopTime * twist.angular}, Twist());
  busy_until_ = time + kStopTime + kSettleTime + skill_.reaction_time;
}

const Rail& FloatingPerson::nearest_rail(const Vector3& to) const {
  return *std::min_element(rails_.begin(), rails_.end(),
                           [&](const Rail& a, const Rail& b) { return a.distance(to) < b.distance(to); });
}

void FloatingPerson::take_rail(double time, std::size_t first, std::size_t last, const Vector3& ahead) {
  if (first == kLeft && last == kRight) drift(time);
  const Pose body = expected_body(time + take_time());
  for (std::size_t hand = first; hand <= last; ++hand) {
    const Vector3 at =
        body.position + ahead +
        body.orientation * Vector3(hand == kLeft ? -kRailGripOffset : kRailGripOffset, 0.0, 0.0);
    const Pose tracked = body * link_in_body_;
    const Rail& rail = nearest_rail(tracked.position + at - body.position);
    take(time, hand, rail.hold(hand == kLeft ? Side::left : Side::right, at, body.orientation));
    arms_[hand].on_rail = true;
  }
}

// ---- Hands.

void FloatingPerson::begin(double time, std::size_t hand, Frame of) {
  Arm& arm = arms_[hand];
  arm.frame = of;
  arm.began = time;
  arm.keyframes = {{0.0, frame(time, of) * arm.now.wrist, arm.now.posture}};
}

/// The hand retreats from what it takes, opens, comes straight from kApproachDistance away, and closes.
/// `hold` is in world.
void FloatingPerson::take(double time, std::size_t hand, Handhold hold) {
  hold.wrist.position += random_.gaussian_vector(skill_.placing_error);
  begin(time, hand, Frame::path);
  Arm& arm = arms_[hand];
  arm.retreat = hold.retreat, arm.open = hold.open, arm.near = hold.near;
  const Pose off = shifted(hold.wrist, kApproachDistance * hold.retreat), now = arm.keyframes.back().wrist;
  const double behind = std::max(0.0, hold.retreat.dot(off.position - now.position));
  append(arm.keyframes, paced(kSidestepTime), shifted(now, behind * hold.retreat), hold.open);
  append(arm.keyframes, skill_.movement_start + skill_.movement_per_bit * kReachBits, off, hold.open);
  const Pose near = shifted(hold.wrist, kPalmGap * hold.retreat);
  append(arm.keyframes, paced(kApproachTime), near, hold.open);
  append(arm.keyframes, paced(kCloseTime), near, hold.near);
  append(arm.keyframes, paced(kGripTime), hold.wrist, hold.closed);
  busy_until_ = std::max(busy_until_, time + arm.keyframes.back().time);
}

/// Opens all hands that hold something, after `delay`.
void FloatingPerson::release(double delay) {
  for (std::size_t hand = 0; hand < kHands; ++hand) {
    Arm& arm = arms_[hand];
    if (!arm.on_rail && !in_hand_) continue;
    const Pose wrist = arm.keyframes.back().wrist, near = shifted(wrist, kPalmGap * arm.retreat);
    append(arm.keyframes, delay, wrist, arm.keyframes.back().posture);
    append(arm.keyframes, paced(kOpenTime), near, arm.near);
    append(arm.keyframes, paced(kOpenTime), near, arm.open);
    append(arm.keyframes, paced(kRetreatTime), shifted(wrist, kApproachDistance * arm.retreat), arm.open);
    arm.on_rail = false;
    busy_until_ = std::max(busy_until_, arm.began + arm.keyframes.back().time);
  }
  in_hand_ = false;
}

void FloatingPerson::rest_hands(double time) {
  for (std::size_t hand = 0; hand < kHands; ++hand) {
    if (arms_[hand].frame == Frame::body || arms_[hand].on_rail) continue;
    begin(time, hand, Frame::body);
    append(arms_[hand].keyframes, paced(kSidestepTime), rest_pose(hand), relaxed_posture());
  }
}

/// From a decision until the hand holds what it takes.
double FloatingPerson::take_time() const {
  return paced(kSidestepTime + kApproachTime + kCloseTime + kGripTime) + skill_.movement_start +
         skill_.movement_per_bit * kReachBits;
}

// ---- Objects.

void FloatingPerson::bring(double time, const FloatingGoal& goal) {
  const Sight& sight = past_.front().sight;
  const Vector3 off = *goal.place - sight.object.position;
  if (in_hand_ && !sight.held) return release(0.0);
  if (in_hand_ && off.norm() > kArmLength) return throw_to(time, off.normalized());
  if (in_hand_ && off.norm() > kCarryTolerance) return carry(time, *goal.place);
  if (in_hand_ && (sight.twist.linear.norm() > kRestSpeed || sight.twist.angular.norm() > kRestSpin)) return;
  if (in_hand_) {
    release(0.0);
    busy_until_ += kReleaseWait;
    return;
  }
  const Vector3 away = sight.object.position - (sight.body * link_in_body_).position;
  if (away.norm() > kArmLength || sight.twist.linear.norm() > kMaxObjectSpeed) return rest_hands(time);
  drift(time);
  for (const auto& [side, in_body] : holds_) {
    Handhold hold = in_body;
    const Pose object = expected(sight.object, sight.twist, time + take_time() - past_.front().time);
    hold.wrist = object * hold.wrist;
    hold.retreat = object.orientation * hold.retreat;
    take(time, arm_of(side), hold);
  }
  in_hand_ = true;
  busy_until_ += kSettleTime + skill_.reaction_time;
}

/// Motion of the body as its hands move the object by `moved`, or at a velocity: their total momentum stays.
Twist FloatingPerson::recoil(const Vector3& moved) const {
  const Sight& sight = past_.front().sight;
  const Vector3 arm = sight.object.position - sight.body.position;
  const Quaternion& turned = sight.body.orientation;
  const Vector3 momentum = turned.conjugate() * arm.cross(object_.mass * moved);
  return {-object_.mass / mass_ * moved, -(turned * (inertia_.inverse() * momentum))};
}

/// Moves all hands on the object as one with it, while the body recoils.
void FloatingPerson::carry(double time, const Vector3& place) {
  const Pose object = past_.front().sight.object;
  const double distance = (place - object.position).norm();
  const double duration = std::max(1.0, distance / kCarrySpeed);
  set_path(time, duration, recoil(place - object.position), Twist());
  for (const auto& [side, hold] : holds_) {
    std::vector<Keyframe>& keyframes = arms_[arm_of(side)].keyframes;
    const Keyframe now = keyframes.back();
    append(keyframes, duration, Pose{place, Quaternion::Identity()} * (object.inverse() * now.wrist),
           now.posture);
  }
  busy_until_ = time + duration + kSettleTime + skill_.reaction_time;
}

/// Brings the object to speed, and opens the hand while it goes along with it.
void FloatingPerson::throw_to(double time, const Vector3& direction) {
  constexpr double kAccelerationTime = 2.0 * kThrowStroke / kThrowSpeed;  // [s]
  const Vector3 velocity = kThrowSpeed * direction;
  const Twist drift = past_.front().sight.body_twist, turned = recoil(kThrowStroke * direction),
              ends = recoil(velocity);
  set_path(
      time, kAccelerationTime,
      {turned.linear + kAccelerationTime * drift.linear, turned.angular + kAccelerationTime * drift.angular},
      {ends.linear + drift.linear, ends.angular + drift.angular});
  for (const auto& [side, hold] : holds_) {
    Arm& arm = arms_[arm_of(side)];
    const Keyframe from = arm.keyframes.back();
    const Pose fast = shifted(from.wrist, kThrowStroke * direction);
    append(arm.keyframes, kAccelerationTime, fast, from.posture, velocity);
    append(arm.keyframes, kReleaseTime / 3.0, shifted(fast, kReleaseTime / 3.0 * velocity), arm.near,
           velocity);
    append(arm.keyframes, kReleaseTime, shifted(fast, 4.0 / 3.0 * kReleaseTime * velocity), arm.open,
           velocity);
    append(arm.keyframes, kRetreatTime,
           shifted(arm.keyframes.back().wrist, 0.2 * velocity + kApproachDistance * arm.retreat), arm.open);
    busy_until_ = time + arm.keyframes.back().time;
  }
  in_hand_ = false;
}

// ---- Devices.

/// With the left hand on a rail. Or with both hands free: then a rail serves to come back.
void FloatingPerson::work(double time, const FloatingGoal& goal) {
  const Sight& sight = past_.front().sight;
  const double speed = sight.body_twist.linear.norm();
  const bool on_rail = arms_[kLeft].on_rail || arms_[kRight].on_rail;
  if (skill_.holds_rail) {
    if (!on_rail) {
      drift(time);
      return take_rail(time, kLeft, kLeft, Vector3::Zero());
    }
    if (speed > 2.0 * kRestSpeed) return stop(time);
  } else {
    const Pose after = expected(sight.body, sight.body_twist, kFreeWorkTime);
    const bool off_course = (after.position - start_.position).norm() > kMaxWorkOffset ||
                            after.orientation.angularDistance(start_.orientation) > kMaxWorkTilt;
    if (on_rail || off_course) {
      if (!come_to_rest(time, start_.position)) return;
      if (on_rail) return release(0.0);
    }
  }
  if (!on_rail) drift(time);
  // Sight corrects a hand at a latch, or beside one on a rail. A free body would be pulled after its handle.
  begin(time, kRight, on_rail || goal.skill != Skilled::pull_hatch ? Frame::seen : Frame::path);
  const Vector3 by = object_.start.position - kHatchPosition + random_.gaussian_vector(skill_.placing_error);
  const double ready = paced(kSidestepTime), duration = on_rail ? 1.0 : kFreeTimeFraction;
  for (Keyframe key : shifted(hatch_motion(goal.skill), by)) {
    key.time = ready + duration * key.time;
    key.velocity /= duration;
    arms_[kRight].keyframes.push_back(key);
  }
  busy_until_ = time + arms_[kRight].keyframes.back().time;
}

}  // namespace mrhi
