#include <algorithm>
#include <cmath>

#include "../math/minimum_jerk.h"
#include "../math/rotation.h"
#include "motions.h"
#include "person.h"

namespace mrhi {
namespace {

constexpr double kGraspWidth = 0.01, kPlaceWidth = 0.02;  // [m] for Fitts' law
constexpr double kMinDuration = 0.3;                      // minimum of a movement [s]
constexpr double kMaxObjectOffset = 0.05;                 // from the object's expected position [m]
constexpr double kMaxGripOffset = 0.04;                   // from the object's position in the hand [m]
constexpr double kMaxTargetWait = 10.0;                   // time at the target without an effect [s]
constexpr double kFirmnessFactor = 1.2, kMaxFirmness = 1.5;
constexpr double kLoadTime = 0.5, kUnloadTime = 0.7, kOpeningTime = 0.5, kWithdrawalTime = 0.7,
                 kReturnTime = 0.8;  // times at pace 1 [s]

constexpr double kMaxApertureFraction = 0.61;  // fraction of the path after which the hand begins to close
constexpr double kTouchDelay = 0.07;           // from feeling to acting [s]
constexpr double kSightDelay =
    0.1;  // from seeing to correcting a movement under way (Paulignan et al. 1991) [s]
constexpr double kMaxCorrectionSpeed = 0.1;  // [m/s]
constexpr double kUnseenFraction = 0.5;      // unseen fraction of an error
constexpr double kLearningTime = 0.25;       // time constant of the grip's stiffness [s]
constexpr double kInitialStiffness = 800.0, kMinStiffness = 20.0;  // of the grip [N/m]
constexpr double kMinFeltFraction = 0.15;  // of the wanted grip: below it something else holds the object
constexpr double kClosingSpeed = 0.05;     // maximum rate of the depth [m/s]
constexpr double kSwingFrequency = 1.0;    // [Hz]

const Vector3 kRestOffset(0.05, -0.16,
                          0.02);  // where the hand waits, relative to the start of its approach [m]

}  // namespace

SimulatedOperator::SimulatedOperator(const OperatorSkill& skill, const Body& object, std::uint64_t seed)
    : Person(skill, seed),
      usual_(grasp_of(object)),
      symmetries_(box_symmetries(object)),
      mass_(object.mass),
      friction_(std::max(0.1, object.material.static_friction)),
      stiffness_(kInitialStiffness) {
  prepare_grasp(1.0);
  const Pose at = wrist_about({object.start.position, Quaternion::Identity()});
  now_ = {shifted(at, kApproachLength * retreat_ + kRestOffset), relaxed_posture()};
  keyframes_ = {{0.0, now_.wrist, now_.posture}};
}

HandPlace SimulatedOperator::move(double time, const Sight& sight) {
  const bool has_seen = remember({time, sight, now_.wrist, depth_});
  const bool under_way = phase_ == Phase::reaching || phase_ == Phase::grasping;
  const Moment seen = under_way ? before(time, std::min(kSightDelay, skill_.reaction_time)) : past_.front();
  if (has_seen) decide(time, seen);
  const double since = time - last_time_;
  correct(since, seen);
  control_grip(time, since);
  HandPlace next = planned(time);
  if (grip_began_) next.posture = postures_->at(depth_);
  if (since > 0.0) {
    velocity_ = (next.wrist.position - now_.wrist.position) / since;
    rate_ = (next.posture - now_.posture) / since;
  }
  last_time_ = time;
  now_ = next;
  next.wrist.position += tremor_.at(time);
  return next;
}

HandPlace SimulatedOperator::planned(double time) const {
  const double elapsed = time - began_;
  HandPlace place = hand_at(keyframes_, elapsed);
  if (!fingers_.empty()) place.posture = hand_at(fingers_, elapsed).posture;
  const double fraction =
      minimum_jerk(std::clamp(elapsed / std::max(keyframes_.back().time, kMinDuration), 0.0, 1.0));
  place.wrist.position +=
      elapsed * drift_ + 2.0 * fraction * (1.0 - fraction) * bow_ + corrected_ + oscillation(time);
  return place;
}

/// Up and down about the target, from rest; with a smaller amplitude in the first second.
Vector3 SimulatedOperator::oscillation(double time) const {
  if (!swing_began_) return Vector3::Zero();
  const double since = time - *swing_began_;
  return 0.5 * std::sin(2.0 * M_PI * kSwingFrequency * since) * minimum_jerk(std::clamp(since, 0.0, 1.0)) *
         swing_;
}

Vector3 SimulatedOperator::acceleration(double time) const {
  constexpr double kStep = 0.01;
  const auto at = [&](double t) -> Vector3 { return planned(t).wrist.position; };
  return (at(time + kStep) - 2.0 * at(time) + at(time - kStep)) / (kStep * kStep);
}

/// Observes the object between the fingers while they close, and moves the hand accordingly.
void SimulatedOperator::correct(double since, const Moment& seen) {
  const bool closing =
      phase_ == Phase::reaching && last_time_ - began_ > kMaxApertureFraction * keyframes_.back().time;
  if (since <= 0.0 || !(closing || (phase_ == Phase::grasping && !arrived(last_time_)))) return;
  Vector3 off = seen.wrist.orientation * (seen.wrist.to_local(seen.sight.object.position) - seen_in_wrist_);
  if (closing) {
    const Vector3 where = expected(aim_.sight.object, aim_.sight.twist, seen.time - aim_.time).position;
    off = seen.sight.object.position - where - (1.0 - kUnseenFraction) * error_in_world_ - corrected_;
  }
  Vector3 speed = kCorrectionRate * off;
  if (speed.norm() > kMaxCorrectionSpeed) speed *= kMaxCorrectionSpeed / speed.norm();
  corrected_ += since * speed;
}

/// The latest moment at least a delay ago.
const SimulatedOperator::Moment& SimulatedOperator::before(double time, double delay) const {
  const auto later = std::find_if(past_.begin(), past_.end(),
                                  [&](const Moment& moment) { return moment.time > time - delay; });
  return later == past_.begin() ? *later : *(later - 1);
}

/// Sets a grip force above the need of the coming load, and the depth for it by the learned stiffness.
void SimulatedOperator::control_grip(double time, double since) {
  if (!grip_began_ || since <= 0.0) return;
  const Moment& touch = before(time, kTouchDelay);
  const bool in_contact = touch.depth > 0.0 && touch.time > *grip_began_;
  const double fraction = minimum_jerk(std::clamp((time - *grip_began_) / (paced(kLoadTime)), 0.0, 1.0));
  const bool assisted =
      fraction == 1.0 && touch.sight.held && touch.sight.grip < kMinFeltFraction * target_force_;
  if (in_contact && !assisted) {
    const double found = std::max(kMinStiffness, touch.sight.grip / touch.depth);
    stiffness_ += std::min(1.0, since / kLearningTime) * (found - stiffness_);
  }
  const double load = mass_ * (acceleration(time) - touch.sight.gravity).norm();
  const double needed = load / (2.0 * friction_);
  target_force_ = fraction * firmness_ * (skill_.least_grip + (1.0 + skill_.grip_margin) * needed);
  const double aim = std::min(postures_->deepest(), target_force_ / stiffness_),
               max_change = kClosingSpeed * since;
  const double from = postures_->near_depth * (1.0 - fraction);
  depth_ += std::clamp(from + aim - depth_, -max_change, max_change);
}

void SimulatedOperator::decide(double time, const Moment& seen) {
  switch (phase_) {
    case Phase::watching:
      return watch(time, seen);
    case Phase::reaching:
      if (is_astray(seen)) return watch(time, seen);
      if (past_.front().sight.size != size_) replan_fingers(past_.front().sight.size);
      if (arrived(time)) grasp(time, seen);
      return;
    case Phase::grasping:
      if (is_astray(seen) || (arrived(time) && distance_from_grip(seen) > kMaxGripOffset)) return withdraw();
      if (arrived(time)) carry(seen);
      return;
    case Phase::carrying:
      if (distance_from_grip(seen) > kMaxGripOffset) return withdraw();
      if (arrived(seen.time)) follow_up(time, seen);
      return;
    case Phase::releasing:
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
  if (seen.sight.place && seen.sight.twist.linear.norm() <= kMaxObjectSpeed) return reach(time, seen);
  if (phase_ == Phase::watching) return;
  plan(Phase::withdrawing, seen);  // stops in place
  append(keyframes_, kMinDuration, shifted(now_.wrist, 0.5 * kMinDuration * velocity_), now_.posture);
}

/// One movement: the hand opens on its path, and has closed around the object on arrival.
void SimulatedOperator::reach(double time, const Moment& seen) {
  prepare_grasp(past_.front().sight.size);
  const double lag = time - seen.time;
  const double distance = (wrist_about(seen.sight.object).position - now_.wrist.position).norm();
  const double duration = movement_time(distance, kGraspWidth);
  const Vector3 drift = seen.sight.twist.linear;
  const Pose wrist = wrist_about(expected(seen.sight.object, seen.sight.twist, lag + duration));
  plan(Phase::reaching, seen, drift);
  append(keyframes_, duration, shifted(wrist, -duration * drift), postures_->near);
  bow_ = kApproachLength * retreat_ +
         0.5 * (keyframes_.back().wrist.position - keyframes_.front().wrist.position);
  fingers_ = {keyframes_.front(), keyframes_.front(), keyframes_.back()};
  fingers_[1].time = kMaxApertureFraction * duration;
  fingers_[1].posture = postures_->open;
}

/// From its present posture and rate the hand opens for the new size, and closes in the time that closing
/// usually takes (Hoff & Arbib 1993). The wrist's path stays, as people's does at first (Castiello et al.
/// 1993); the hand waits at its end for the fingers.
void SimulatedOperator::replan_fingers(double size) {
  fit_to(size);
  const double reach = keyframes_.back().time, since = last_time_ - began_;
  const double widest = std::max(kMaxApertureFraction * reach, since + kMinDuration);
  fingers_[0].time = since;
  fingers_[0].posture = now_.posture;
  fingers_[0].rate = rate_;
  fingers_[1].time = widest;
  fingers_[1].posture = postures_->open;
  fingers_[2].time = widest + (1.0 - kMaxApertureFraction) * reach;
  fingers_[2].posture = postures_->near;
}

void SimulatedOperator::grasp(double time, const Moment& seen) {
  const double close = paced(kLoadTime), settle = skill_.reaction_time + skill_.decision_time;
  const Vector3 drift = drift_;
  const Pose wrist = now_.wrist;
  plan(Phase::grasping, seen, drift);
  grip_began_ = time;
  depth_ = postures_->near_depth;
  append(keyframes_, close, wrist, now_.posture);
  append(keyframes_, settle, shifted(wrist, -0.5 * settle * drift), now_.posture);
  keyframes_.back().velocity = -drift;
}

void SimulatedOperator::carry(const Moment& seen) {
  if (!seen.sight.place) return release();
  in_hand_ = seen.wrist.to_local(seen.sight.object.position);
  const Vector3 wrist = *seen.sight.place - now_.wrist.orientation * in_hand_;
  const double duration = movement_time((wrist - now_.wrist.position).norm(), kPlaceWidth);
  plan(Phase::carrying, seen);
  append(keyframes_, duration, {wrist, now_.wrist.orientation}, now_.posture);
}

/// Checks that the object is at its target.
void SimulatedOperator::follow_up(double time, const Moment& seen) {
  if (!seen.sight.place) return release();
  if (seen.sight.swing != Vector3::Zero()) {
    if (!swing_began_) swing_began_ = time;
    swing_ = seen.sight.swing;
    return;
  }
  const double precision = std::min(skill_.precision, seen.sight.precision);
  const bool missed = (seen.sight.object.position - *seen.sight.place).norm() > precision;
  if (missed) return carry(seen);
  if (time > began_ + keyframes_.back().time + kMaxTargetWait) withdraw();
}

void SimulatedOperator::release() {
  const Pose wrist = now_.wrist;
  plan(Phase::releasing, aim_);
  close_to(postures_->near_depth, paced(kUnloadTime));
  append(keyframes_, paced(kOpeningTime), wrist, postures_->open);
  append(keyframes_, paced(kWithdrawalTime), shifted(wrist, kApproachLength * retreat_), postures_->open);
  keyframes_.back().velocity = 0.1 * retreat_;
  append(keyframes_, paced(kReturnTime), shifted(wrist, kApproachLength * retreat_ + kRestOffset),
         relaxed_posture());
}

/// A released object still adheres to the hand: rotates the flat hand.
void SimulatedOperator::shake_off() {
  const Quaternion over = now_.wrist.orientation * turn(120.0, Vector3::UnitX());
  const Vector3 away = now_.wrist.position + 0.5 * kApproachLength * retreat_;
  plan(Phase::releasing, aim_);
  append(keyframes_, paced(kOpeningTime), {away, now_.wrist.orientation}, flat_posture());
  append(keyframes_, paced(kOpeningTime), {away, over}, flat_posture());
}

void SimulatedOperator::withdraw() {
  firmness_ = std::min(kMaxFirmness, kFirmnessFactor * firmness_);
  grip_began_.reset();
  plan(Phase::withdrawing, aim_);
  append(keyframes_, paced(kOpeningTime), shifted(now_.wrist, kApproachLength * retreat_), postures_->open);
}

void SimulatedOperator::prepare_grasp(double size) {
  grasp_ = usual_;
  const double usual_depth = grasp_.contacts[0].depth + grasp_.contacts[1].depth;
  for (FingertipContact& contact : grasp_.contacts) {
    contact.depth /= usual_depth;
    contact.depth *= std::max(0.0, 1.0 + skill_.grip_spread * random_.gaussian());
  }
  grasp_.opening = skill_.opening;
  fit_to(size);
  grasp_error_.position = random_.gaussian_vector(skill_.placing_error);
  grasp_error_.orientation = rotation_by(random_.gaussian_vector(skill_.turning_error));
}

/// Plans the fingers for an object of this size: its surfaces are moved along their normals.
void SimulatedOperator::fit_to(double size) {
  size_ = size;
  Grasp grasp = grasp_;
  for (FingertipContact& contact : grasp.contacts)
    contact.point += (size - 1.0) * contact.normal.dot(contact.point) * contact.normal;
  postures_.emplace(grasp, skill_.grip_depth);
}

/// Returns the wrist pose of the grasp with the least rotation among those allowed by the object's symmetry.
Pose SimulatedOperator::wrist_about(const Pose& object) {
  const Quaternion comfortable = usual_.wrist.orientation;
  const auto strain = [&](const Quaternion& turn) {
    return comfortable.angularDistance(object.orientation * turn * comfortable);
  };
  const Quaternion turn =
      *std::min_element(symmetries_.begin(), symmetries_.end(),
                        [&](const Quaternion& a, const Quaternion& b) { return strain(a) < strain(b); });
  const Pose wrist = grasp_error_ * Pose{Vector3::Zero(), turn} * usual_.wrist;
  retreat_ = object.orientation * turn * usual_.retreat;
  in_hand_ = wrist.to_local(Vector3::Zero());
  seen_in_wrist_ =
      in_hand_ + (1.0 - kUnseenFraction) * (wrist.orientation.conjugate() * grasp_error_.position);
  error_in_world_ = object.orientation * grasp_error_.position;
  return object * wrist;
}

/// Begins at the hand's present pose and velocity.
void SimulatedOperator::plan(Phase phase, const Moment& seen, const Vector3& drift) {
  const Vector3 velocity = velocity_ - drift;
  phase_ = phase;
  began_ = last_time_;
  aim_ = seen;
  drift_ = drift;
  keyframes_ = {{0.0, now_.wrist, now_.posture, velocity}};
  fingers_.clear();
  bow_ = corrected_ = Vector3::Zero();
  swing_began_.reset();
  if (phase == Phase::reaching || phase == Phase::withdrawing) grip_began_.reset();
}

/// Moves the fingers only.
void SimulatedOperator::close_to(double depth, double duration) {
  constexpr int kSteps = 8;
  const Pose wrist = now_.wrist;
  grip_began_.reset();
  for (int i = 1; i <= kSteps; ++i) {
    const double fraction = minimum_jerk(static_cast<double>(i) / kSteps);
    append(keyframes_, duration / kSteps, wrist, postures_->at(depth_ + fraction * (depth - depth_)));
  }
}

bool SimulatedOperator::is_astray(const Moment& seen) const {
  const Vector3 where = aim_.sight.object.position + (seen.time - aim_.time) * drift_;
  return (seen.sight.object.position - where).norm() > kMaxObjectOffset;
}

double SimulatedOperator::distance_from_grip(const Moment& seen) const {
  return (seen.wrist.to_local(seen.sight.object.position) - in_hand_).norm();
}

double SimulatedOperator::movement_time(double distance, double width) const {
  const double fitts = skill_.movement_start + skill_.movement_per_bit * std::log2(distance / width + 1.0);
  return std::max(kMinDuration, fitts);
}

}  // namespace mrhi
