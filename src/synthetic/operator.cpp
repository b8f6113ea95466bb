#include "operator.h"

#include <algorithm>
#include <cmath>

#include "../math/minimum_jerk.h"
#include "../math/rotation.h"
#include "motions.h"

namespace mrhi {
namespace {

constexpr double kApproach = 0.10;                        // straight to the object with the hand open [m]
constexpr double kGraspWidth = 0.01, kPlaceWidth = 0.02;  // [m] for Fitts' law
constexpr double kMinDuration = 0.3;                      // minimum of a movement [s]
constexpr double kCatchable = 0.1;                        // faster objects are not pursued [m/s]
constexpr double kAstray = 0.05;                          // from the object's expected position [m]
constexpr double kOutOfHand = 0.04;                       // from the object's position in the hand [m]
constexpr double kPatience = 10.0;                        // time at the target without an effect [s]
constexpr double kFirmer = 1.2, kFirmest = 1.5;
constexpr double kLoad = 0.5, kUnload = 0.7, kOpen = 0.5, kRetreat = 0.7,
                 kGoAside = 0.8;  // times at pace 1 [s]

constexpr double kWidest = 0.61;  // fraction of the path after which the hand begins to close
constexpr double kTouch = 0.07;   // from feeling to acting [s]
constexpr double kSight = 0.1;  // from seeing to correcting a movement under way (Paulignan et al. 1991) [s]
constexpr double kCorrecting = 2.0;      // rate of correcting a seen error [1/s]
constexpr double kFastCorrection = 0.1;  // [m/s]
constexpr double kUnseen = 0.5;          // unseen fraction of an error
constexpr double kLearning = 0.25;       // time constant of the grip's stiffness [s]
constexpr double kInitialStiffness = 800.0, kMinStiffness = 20.0;  // of the grip [N/m]
constexpr double kUnfelt = 0.15;        // of the wanted grip: below it something else holds the object
constexpr double kClosingSpeed = 0.05;  // maximum rate of the depth [m/s]
constexpr double kSwing = 1.0;          // [Hz]

const Vector3 kRest(0.05, -0.16, 0.02);  // where the hand waits, relative to the start of its approach [m]

/// Pose of the object after `ahead` seconds at its present velocity.
Pose expected(const Sight& sight, double ahead) {
  return {sight.object.position + ahead * sight.twist.linear,
          (rotation_by(ahead * sight.twist.angular) * sight.object.orientation).normalized()};
}

}  // namespace

SimulatedOperator::SimulatedOperator(const OperatorSkill& skill, const Body& object, std::uint64_t seed)
    : skill_(skill),
      usual_(grasp_of(object)),
      turns_(box_symmetries(object)),
      random_(seed),
      tremor_(skill.tremor, random_),
      mass_(object.mass),
      friction_(std::max(0.1, object.material.static_friction)),
      stiffness_(kInitialStiffness) {
  prepare_grasp(1.0);
  const Pose at = wrist_about({object.start.position, Quaternion::Identity()});
  now_ = {shifted(at, kApproach * retreat_ + kRest), relaxed_posture()};
  way_ = {{0.0, now_.wrist, now_.posture}};
}

HandPlace SimulatedOperator::move(double time, const Sight& sight) {
  past_.push_back({time, sight, now_.wrist, depth_});
  while (past_.size() > 1 && past_[1].time <= time - skill_.reaction_time) past_.pop_front();
  const bool under_way = phase_ == Phase::reaching || phase_ == Phase::grasping;
  const Moment seen = under_way ? before(time, std::min(kSight, skill_.reaction_time)) : past_.front();
  if (past_.front().time <= time - skill_.reaction_time) decide(time, seen);
  const double since = time - last_time_;
  correct(since, seen);
  squeeze(time, since);
  HandPlace next = planned(time);
  if (gripping_) next.posture = postures_->at(depth_);
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
  const double on_way = time - began_;
  HandPlace place = hand_at(way_, on_way);
  if (!fingers_.empty()) place.posture = hand_at(fingers_, on_way).posture;
  const double share = minimum_jerk(std::clamp(on_way / std::max(way_.back().time, kMinDuration), 0.0, 1.0));
  place.wrist.position += on_way * drift_ + 2.0 * share * (1.0 - share) * bow_ + corrected_ + swung(time);
  return place;
}

/// Up and down about the target, from rest; with a smaller amplitude in the first second.
Vector3 SimulatedOperator::swung(double time) const {
  if (!swing_began_) return Vector3::Zero();
  const double since = time - *swing_began_;
  return 0.5 * std::sin(2.0 * M_PI * kSwing * since) * minimum_jerk(std::clamp(since, 0.0, 1.0)) * swing_;
}

Vector3 SimulatedOperator::acceleration(double time) const {
  constexpr double kStep = 0.01;
  const auto at = [&](double t) -> Vector3 { return planned(t).wrist.position; };
  return (at(time + kStep) - 2.0 * at(time) + at(time - kStep)) / (kStep * kStep);
}

/// Observes the object between the fingers while they close, and moves the hand accordingly.
void SimulatedOperator::correct(double since, const Moment& seen) {
  const bool closing = phase_ == Phase::reaching && last_time_ - began_ > kWidest * way_.back().time;
  if (since <= 0.0 || !(closing || (phase_ == Phase::grasping && !arrived(last_time_)))) return;
  Vector3 off = seen.wrist.orientation * (seen.wrist.to_local(seen.sight.object.position) - middle_);
  if (closing) {
    const Vector3 where = expected(aim_.sight, seen.time - aim_.time).position;
    off = seen.sight.object.position - where - (1.0 - kUnseen) * beside_ - corrected_;
  }
  Vector3 speed = kCorrecting * off;
  if (speed.norm() > kFastCorrection) speed *= kFastCorrection / speed.norm();
  corrected_ += since * speed;
}

/// The latest moment at least a delay ago.
const SimulatedOperator::Moment& SimulatedOperator::before(double time, double delay) const {
  const auto later = std::find_if(past_.begin(), past_.end(),
                                  [&](const Moment& moment) { return moment.time > time - delay; });
  return later == past_.begin() ? *later : *(later - 1);
}

/// Sets a grip force above the need of the coming load, and the depth for it by the learned stiffness.
void SimulatedOperator::squeeze(double time, double since) {
  if (!gripping_ || since <= 0.0) return;
  const Moment& touch = before(time, kTouch);
  const bool pressed = touch.depth > 0.0 && touch.time > *gripping_;
  const double share = minimum_jerk(std::clamp((time - *gripping_) / (kLoad * skill_.pace), 0.0, 1.0));
  const bool helped = share == 1.0 && touch.sight.held && touch.sight.grip < kUnfelt * wanted_;
  if (pressed && !helped) {
    const double found = std::max(kMinStiffness, touch.sight.grip / touch.depth);
    stiffness_ += std::min(1.0, since / kLearning) * (found - stiffness_);
  }
  const double load = mass_ * (acceleration(time) - touch.sight.gravity).norm();
  const double needed = load / (2.0 * friction_);
  wanted_ = share * firmness_ * (skill_.least_grip + (1.0 + skill_.grip_margin) * needed);
  const double aim = std::min(postures_->deepest(), wanted_ / stiffness_), most = kClosingSpeed * since;
  const double from = postures_->near_depth * (1.0 - share);
  depth_ += std::clamp(from + aim - depth_, -most, most);
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
  plan(Phase::withdrawing, seen);  // stops in place
  then(kMinDuration, shifted(now_.wrist, 0.5 * kMinDuration * velocity_), now_.posture);
}

/// One movement: the hand opens on its path, and has closed around the object on arrival.
void SimulatedOperator::reach(double time, const Moment& seen) {
  prepare_grasp(past_.front().sight.size);
  const double lag = time - seen.time;
  const double distance = (wrist_about(seen.sight.object).position - now_.wrist.position).norm();
  const double duration = movement_time(distance, kGraspWidth);
  const Vector3 drift = seen.sight.twist.linear;
  const Pose wrist = wrist_about(expected(seen.sight, lag + duration));
  plan(Phase::reaching, seen, drift);
  then(duration, shifted(wrist, -duration * drift), postures_->near);
  bow_ = kApproach * retreat_ + 0.5 * (way_.back().wrist.position - way_.front().wrist.position);
  fingers_ = {way_.front(), way_.front(), way_.back()};
  fingers_[1].time = kWidest * duration;
  fingers_[1].posture = postures_->open;
}

/// From its present posture and rate the hand opens for the new size, and closes in the time that closing
/// usually takes (Hoff & Arbib 1993). The wrist's path stays, as people's does at first (Castiello et al.
/// 1993); the hand waits at its end for the fingers.
void SimulatedOperator::replan_fingers(double size) {
  fit_to(size);
  const double reach = way_.back().time, since = last_time_ - began_;
  const double widest = std::max(kWidest * reach, since + kMinDuration);
  fingers_ = {way_.front(), way_.front(), way_.back()};
  fingers_[0].time = since;
  fingers_[0].posture = now_.posture;
  fingers_[0].rate = rate_;
  fingers_[1].time = widest;
  fingers_[1].posture = postures_->open;
  fingers_[2].time = widest + (1.0 - kWidest) * reach;
  fingers_[2].posture = postures_->near;
}

void SimulatedOperator::grasp(double time, const Moment& seen) {
  const double close = kLoad * skill_.pace, settle = skill_.reaction_time + skill_.decision_time;
  const Vector3 drift = drift_;
  const Pose wrist = now_.wrist;
  plan(Phase::grasping, seen, drift);
  gripping_ = time;
  depth_ = postures_->near_depth;
  then(close, wrist, now_.posture);
  then(settle, shifted(wrist, -0.5 * settle * drift), now_.posture);
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

/// Checks that the object is at its target.
void SimulatedOperator::follow_up(double time, const Moment& seen) {
  if (!seen.sight.place) return let_go();
  if (seen.sight.swing != Vector3::Zero()) {
    if (!swing_began_) swing_began_ = time;
    swing_ = seen.sight.swing;
    return;
  }
  const double precision = std::min(skill_.precision, seen.sight.precision);
  const bool missed = (seen.sight.object.position - *seen.sight.place).norm() > precision;
  if (missed) return carry(seen);
  if (time > began_ + way_.back().time + kPatience) lose();
}

void SimulatedOperator::let_go() {
  const Pose wrist = now_.wrist;
  plan(Phase::letting_go, aim_);
  close_to(postures_->near_depth, kUnload * skill_.pace);
  then(kOpen * skill_.pace, wrist, postures_->open);
  then(kRetreat * skill_.pace, shifted(wrist, kApproach * retreat_), postures_->open);
  way_.back().velocity = 0.1 * retreat_;
  then(kGoAside * skill_.pace, shifted(wrist, kApproach * retreat_ + kRest), relaxed_posture());
}

/// A released object still adheres to the hand: rotates the flat hand.
void SimulatedOperator::shake_off() {
  const Quaternion over = now_.wrist.orientation * turn(120.0, Vector3::UnitX());
  const Vector3 away = now_.wrist.position + 0.5 * kApproach * retreat_;
  plan(Phase::letting_go, aim_);
  then(kOpen * skill_.pace, {away, now_.wrist.orientation}, flat_posture());
  then(kOpen * skill_.pace, {away, over}, flat_posture());
}

void SimulatedOperator::lose() {
  firmness_ = std::min(kFirmest, kFirmer * firmness_);
  gripping_.reset();
  plan(Phase::withdrawing, aim_);
  then(kOpen * skill_.pace, shifted(now_.wrist, kApproach * retreat_), postures_->open);
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
  misplaced_.position = random_.gaussian_vector(skill_.placing_error);
  misplaced_.orientation = rotation_by(random_.gaussian_vector(skill_.turning_error));
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
      *std::min_element(turns_.begin(), turns_.end(),
                        [&](const Quaternion& a, const Quaternion& b) { return strain(a) < strain(b); });
  const Pose wrist = misplaced_ * Pose{Vector3::Zero(), turn} * usual_.wrist;
  retreat_ = object.orientation * turn * usual_.retreat;
  in_hand_ = wrist.to_local(Vector3::Zero());
  middle_ = in_hand_ + (1.0 - kUnseen) * (wrist.orientation.conjugate() * misplaced_.position);
  beside_ = object.orientation * misplaced_.position;
  return object * wrist;
}

/// Begins at the hand's present pose and velocity.
void SimulatedOperator::plan(Phase phase, const Moment& seen, const Vector3& drift) {
  const Vector3 velocity = velocity_ - drift;
  phase_ = phase;
  began_ = last_time_;
  aim_ = seen;
  drift_ = drift;
  way_ = {{0.0, now_.wrist, now_.posture, velocity}};
  fingers_.clear();
  bow_ = corrected_ = Vector3::Zero();
  swing_began_.reset();
  if (phase == Phase::reaching || phase == Phase::withdrawing) gripping_.reset();
}

void SimulatedOperator::then(double duration, const Pose& wrist, const HandPosture& posture) {
  way_.push_back({way_.back().time + duration, wrist, posture});
}

/// Moves the fingers only.
void SimulatedOperator::close_to(double depth, double duration) {
  constexpr int kSteps = 8;
  const Pose wrist = now_.wrist;
  gripping_.reset();
  for (int i = 1; i <= kSteps; ++i) {
    const double share = minimum_jerk(static_cast<double>(i) / kSteps);
    then(duration / kSteps, wrist, postures_->at(depth_ + share * (depth - depth_)));
  }
}

bool SimulatedOperator::is_astray(const Moment& seen) const {
  const Vector3 where = aim_.sight.object.position + (seen.time - aim_.time) * drift_;
  return (seen.sight.object.position - where).norm() > kAstray;
}

double SimulatedOperator::distance_from_grip(const Moment& seen) const {
  return (seen.wrist.to_local(seen.sight.object.position) - in_hand_).norm();
}

double SimulatedOperator::movement_time(double distance, double width) const {
  const double fitts = skill_.movement_start + skill_.movement_per_bit * std::log2(distance / width + 1.0);
  return std::max(kMinDuration, fitts);
}

}  // namespace mrhi
