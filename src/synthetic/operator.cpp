#include "mr_hand_interaction/synthetic/operator.h"

#include <algorithm>
#include <cmath>

#include "box_symmetries.h"
#include "motions.h"

namespace mrhi {
namespace {

constexpr double kApproach = 0.10;  // [m] straight to the object with the hand open
constexpr double kReachWidth = 0.03, kGraspWidth = 0.01, kPlaceWidth = 0.02;  // [m] for Fitts' law
constexpr double kLeastTime = 0.3;                                            // of a movement [s]
constexpr double kCatchable = 0.1;   // what is faster is left to go [m/s]
constexpr double kAstray = 0.05;     // from where the object was expected [m]
constexpr double kOutOfHand = 0.04;  // from where the object was in the hand [m]
constexpr double kPatience = 10.0;  // with an object that is held where it is wanted, and nothing happens [s]
constexpr double kFirmer = 1.2, kFirmest = 1.5;
constexpr double kNear = 0.6, kClose = 0.7, kOpen = 0.5, kRetreat = 0.7, kAside = 0.8;  // times at pace 1 [s]

const Vector3 kRest(0.05, -0.16, 0.02);  // where the hand waits, from where it begins to approach [m]

Pose shifted(const Pose& pose, const Vector3& by) {
  return {pose.position + by, pose.orientation};
}

Quaternion rotation(const Vector3& vector) {
  const double angle = vector.norm();
  if (angle == 0.0) return Quaternion::Identity();
  return Quaternion(Eigen::AngleAxisd(angle, vector / angle));
}

/// Where the object will be, if it goes on as it does.
Pose expected(const Sight& sight, double ahead) {
  return {sight.object.position + ahead * sight.twist.linear,
          (rotation(ahead * sight.twist.angular) * sight.object.orientation).normalized()};
}

}  // namespace

SimulatedOperator::SimulatedOperator(const OperatorSkill& skill, const Body& object, std::uint64_t seed)
    : skill_(skill), usual_(shipped_grasp(object.name)), turns_(box_symmetries(object)), random_(seed) {
  constexpr int kWaves = 3;
  for (int i = 0; i < kWaves; ++i) {
    const double frequency = 8.0 + 4.0 * random_.uniform(), phase = 2.0 * M_PI * random_.uniform();
    tremor_.push_back({frequency, phase, random_.gaussian_vector(skill_.tremor * std::sqrt(2.0 / kWaves))});
  }
  prepare_grasp();
  const Pose at = wrist_about({object.start.position, Quaternion::Identity()});
  now_ = {shifted(at, kApproach * retreat_ + kRest), relaxed_posture()};
  way_ = {{0.0, now_.wrist, now_.posture}};
}

HandPlace SimulatedOperator::move(double time, const Sight& sight) {
  past_.push_back({time, sight, now_.wrist});
  while (past_.size() > 1 && past_[1].time <= time - skill_.reaction_time) past_.pop_front();
  if (past_.front().time <= time - skill_.reaction_time) decide(time, past_.front());
  HandPlace next = hand_at(way_, time - began_);
  next.wrist.position += (time - began_) * drift_;
  if (time > last_time_) velocity_ = (next.wrist.position - now_.wrist.position) / (time - last_time_);
  last_time_ = time;
  now_ = next;
  next.wrist.position += trembling(time);
  return next;
}

void SimulatedOperator::decide(double time, const Moment& seen) {
  switch (phase_) {
    case Phase::watching:
      return watch(time, seen);
    case Phase::reaching:
      if (is_astray(seen)) return watch(time, seen);
      if (arrived(time)) grasp(time, seen);
      return;
    case Phase::grasping:
      if (is_astray(seen) || (arrived(time) && distance_from_grip(seen) > kOutOfHand)) return lose();
      if (arrived(time)) carry(seen);
      return;
    case Phase::carrying:
      if (distance_from_grip(seen) > kOutOfHand) return lose();
      if (arrived(seen.time)) follow_up(time, seen);
      return;
    case Phase::letting_go:
      if (arrived(time)) phase_ = Phase::done;
      return;
    case Phase::withdrawing:
      if (arrived(time)) phase_ = Phase::watching;
      return;
    case Phase::done:
      if (seen.sight.place) {
        phase_ = Phase::watching;
      } else if (seen.sight.held) {
        shake_off();
      }
      return;
  }
}

void SimulatedOperator::watch(double time, const Moment& seen) {
  if (seen.sight.place && seen.sight.twist.linear.norm() <= kCatchable) return reach(time, seen);
  if (phase_ == Phase::watching) return;
  plan(Phase::withdrawing, seen);  // stops where it is
  then(kLeastTime, shifted(now_.wrist, 0.5 * kLeastTime * velocity_), now_.posture);
}

void SimulatedOperator::reach(double time, const Moment& seen) {
  prepare_grasp();
  const double lag = time - seen.time;
  const double distance = (wrist_about(seen.sight.object).position - now_.wrist.position).norm();
  const double duration = movement_time(distance, kReachWidth);
  const Vector3 drift = seen.sight.twist.linear;
  const Pose wrist = wrist_about(expected(seen.sight, lag + duration));
  plan(Phase::reaching, seen, drift);
  then(duration, shifted(wrist, kApproach * retreat_ - duration * drift), postures_->open);
}

void SimulatedOperator::grasp(double time, const Moment& seen) {
  const double approach = movement_time(kApproach, kGraspWidth);
  const double near = kNear * skill_.pace, close = kClose * skill_.pace;
  const double settle = skill_.reaction_time + skill_.decision_time;
  const double until_closed = approach + near + 0.5 * close;
  const Vector3 drift = seen.sight.twist.linear;
  const Pose met = wrist_about(expected(seen.sight, time - seen.time + until_closed));
  const Pose wrist = shifted(met, -until_closed * drift);
  plan(Phase::grasping, seen, drift);
  then(approach, wrist, postures_->open);
  then(near, wrist, postures_->near);
  then(close, wrist, postures_->pressing);
  way_.back().via = postures_->touching;
  way_.back().via_share = postures_->touching_share;
  then(settle, shifted(wrist, -0.5 * settle * drift), postures_->pressing);
  way_.back().velocity = -drift;
}

void SimulatedOperator::carry(const Moment& seen) {
  if (!seen.sight.place) return let_go();
  in_hand_ = seen.wrist.to_local(seen.sight.object.position);
  const Vector3 wrist = *seen.sight.place - now_.wrist.orientation * in_hand_;
  const double duration = movement_time((wrist - now_.wrist.position).norm(), kPlaceWidth);
  plan(Phase::carrying, seen);
  then(duration, {wrist, now_.wrist.orientation}, now_.posture);
}

/// The object should be where it was wanted.
void SimulatedOperator::follow_up(double time, const Moment& seen) {
  if (!seen.sight.place) return let_go();
  const double precision = std::min(skill_.precision, seen.sight.precision);
  const bool missed = (seen.sight.object.position - *seen.sight.place).norm() > precision;
  if (missed) return carry(seen);
  if (time > began_ + way_.back().time + kPatience) lose();
}

void SimulatedOperator::let_go() {
  const Pose wrist = now_.wrist;
  plan(Phase::letting_go, aim_);
  then(kClose * skill_.pace, wrist, postures_->near);
  way_.back().via = postures_->touching;
  way_.back().via_share = 1.0 - postures_->touching_share;
  then(kOpen * skill_.pace, wrist, postures_->open);
  then(kRetreat * skill_.pace, shifted(wrist, kApproach * retreat_), postures_->open);
  way_.back().velocity = 0.1 * retreat_;
  then(kAside * skill_.pace, shifted(wrist, kApproach * retreat_ + kRest), relaxed_posture());
}

/// What it has let go still clings to its hand: turns the flat hand over.
void SimulatedOperator::shake_off() {
  const Quaternion over = now_.wrist.orientation * turn(120.0, Vector3::UnitX());
  const Vector3 away = now_.wrist.position + 0.5 * kApproach * retreat_;
  plan(Phase::letting_go, aim_);
  then(kOpen * skill_.pace, {away, now_.wrist.orientation}, flat_posture());
  then(kOpen * skill_.pace, {away, over}, flat_posture());
}

void SimulatedOperator::lose() {
  firmness_ = std::min(kFirmest, kFirmer * firmness_);
  plan(Phase::withdrawing, aim_);
  then(kOpen * skill_.pace, shifted(now_.wrist, kApproach * retreat_), postures_->open);
}

void SimulatedOperator::prepare_grasp() {
  Grasp grasp = usual_;
  const double usual_depth = grasp.contacts[0].depth + grasp.contacts[1].depth;
  for (FingertipContact& contact : grasp.contacts) {
    contact.depth *= firmness_ * skill_.grip_depth / usual_depth;
    contact.depth *= std::max(0.0, 1.0 + skill_.grip_spread * random_.gaussian());
  }
  grasp.opening = skill_.opening;
  postures_.emplace(grasp);
  misplaced_.position = random_.gaussian_vector(skill_.placing_error);
  misplaced_.orientation = rotation(random_.gaussian_vector(skill_.turning_error));
}

/// Of the grasps that the object's symmetry allows the one with the wrist turned least.
Pose SimulatedOperator::wrist_about(const Pose& object) {
  const Quaternion comfortable = usual_.wrist.orientation;
  const auto strain = [&](const Quaternion& turn) {
    return comfortable.angularDistance(object.orientation * turn * comfortable);
  };
  const Quaternion turn =
      *std::min_element(turns_.begin(), turns_.end(),
                        [&](const Quaternion& a, const Quaternion& b) { return strain(a) < strain(b); });
  const Pose wrist = misplaced_ * Pose{Vector3::Zero(), turn} * usual_.wrist;
  retreat_ = object.orientation * turn * usual_.retreat;
  in_hand_ = wrist.to_local(Vector3::Zero());
  return object * wrist;
}

/// From where the hand is, and as fast as it is.
void SimulatedOperator::plan(Phase phase, const Moment& seen, const Vector3& drift) {
  const Vector3 velocity = velocity_ - drift;
  phase_ = phase;
  began_ = last_time_;
  aim_ = seen;
  drift_ = drift;
  way_ = {{0.0, now_.wrist, now_.posture, velocity}};
}

void SimulatedOperator::then(double duration, const Pose& wrist, const HandPosture& posture) {
  way_.push_back({way_.back().time + duration, wrist, posture});
}

bool SimulatedOperator::is_astray(const Moment& seen) const {
  const Pose where = expected(aim_.sight, seen.time - aim_.time);
  return (seen.sight.object.position - where.position).norm() > kAstray;
}

double SimulatedOperator::distance_from_grip(const Moment& seen) const {
  return (seen.wrist.to_local(seen.sight.object.position) - in_hand_).norm();
}

double SimulatedOperator::movement_time(double distance, double width) const {
  const double fitts = skill_.movement_start + skill_.movement_per_bit * std::log2(distance / width + 1.0);
  return std::max(kLeastTime, fitts);
}

Vector3 SimulatedOperator::trembling(double time) const {
  Vector3 sum = Vector3::Zero();
  for (const Tremor& wave : tremor_)
    sum += std::sin(2.0 * M_PI * wave.frequency * time + wave.phase) * wave.amplitude;
  return sum;
}

}  // namespace mrhi
