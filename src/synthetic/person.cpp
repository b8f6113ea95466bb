#include "person.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "../math/rotation.h"
#include "motions.h"
#include "mr_hand_interaction/synthetic/random.h"

namespace mrhi {
namespace {

constexpr double kSpread = 0.2, kMinFactor = 0.5, kMaxFactor = 1.6;  // of one person relative to the group

/// A value for both groups.
struct Figure {
  double OperatorSkill::*value;
  double beginner, veteran;
  bool personal = true;  // varies from person to person
};
constexpr Figure kFigures[] = {{&OperatorSkill::reaction_time, 0.25, 0.20},
                               {&OperatorSkill::movement_start, 0.2, 0.2},
                               {&OperatorSkill::movement_per_bit, 0.30, 0.20},
                               {&OperatorSkill::pace, 1.0, 0.75},
                               {&OperatorSkill::decision_time, 0.6, 0.3},
                               {&OperatorSkill::placing_error, 0.006, 0.003},
                               {&OperatorSkill::turning_error, 6.0 * kDegree, 3.0 * kDegree},
                               {&OperatorSkill::tremor, 0.0004, 0.0002},
                               {&OperatorSkill::grip_depth, 0.021, 0.018},
                               {&OperatorSkill::least_grip, 3.0, 2.5},
                               {&OperatorSkill::grip_margin, 1.2, 1.0},
                               {&OperatorSkill::grip_spread, 0.2, 0.1, false}};

OperatorSkill skill_of(double Figure::*group) {
  OperatorSkill skill;
  for (const Figure& figure : kFigures) skill.*figure.value = figure.*group;
  return skill;
}

constexpr double kMaxTargetSpeed = 0.05;          // faster objects are not pursued [m/s]
constexpr double kPreparationTime = 0.9;          // at pace 1, before a motion [s]
const Vector3 kWaitingOffset(0.05, -0.35, 0.05);  // of the waiting hand from its target [m]

double half_height(const Body& body) {
  const auto* box = std::get_if<Box>(&body.shapes.at(0).shape);
  return box != nullptr ? box->half_extents.z() : body.bounding_radius;
}

/// Returns the keyframes up to `end`.
std::vector<Keyframe> until(std::vector<Keyframe> keys, double end) {
  keys.erase(std::find_if(keys.begin(), keys.end(), [&](const Keyframe& key) { return key.time > end; }),
             keys.end());
  return keys;
}

/// Returns the keyframes of the last `seconds`, with times from their start.
std::vector<Keyframe> last(std::vector<Keyframe> keys, double seconds) {
  const double begin = keys.back().time - seconds;
  keys.erase(keys.begin(),
             std::find_if(keys.begin(), keys.end(), [&](const Keyframe& key) { return key.time >= begin; }));
  for (Keyframe& key : keys) key.time -= begin;
  return keys;
}

std::vector<Keyframe> backwards(const std::vector<Keyframe>& keys) {
  std::vector<Keyframe> back;
  for (auto key = keys.rbegin(); key != keys.rend(); ++key) {
    Keyframe other = *key;
    other.time = keys.back().time - key->time;
    other.velocity = -key->velocity;
    other.centre = key == keys.rbegin() ? std::nullopt : (key - 1)->centre;
    other.via_share = key == keys.rbegin() ? 0.0 : 1.0 - (key - 1)->via_share;
    if (key != keys.rbegin() && (key - 1)->via_share == 0.0) other.via_share = 0.0;
    other.via = key == keys.rbegin() ? other.via : (key - 1)->via;
    back.push_back(other);
  }
  return back;
}

/// A finger pushes the object along x of `about`, and the palm stops it at its target.
std::vector<Keyframe> nudge_and_stop(const Vector3& object, const Vector3& place) {
  const std::vector<Keyframe> nudge = make_motion("nudge").keyframes, slap = make_motion("slap").keyframes;
  const Vector3 path = place - object;
  const Quaternion along(Eigen::AngleAxisd(std::atan2(path.y(), path.x()), Vector3::UnitZ()));
  const auto at = [&](const Vector3& from, const Quaternion& turned, const Pose& wrist) {
    return Pose{from, along * turned} * Pose{wrist.position - scene_object(), wrist.orientation};
  };
  const Quaternion pushes_along_y = turn(-90.0, Vector3::UnitZ());
  const Pose ready = at(object, pushes_along_y, nudge[1].wrist),
             pushed = at(object, pushes_along_y, nudge[3].wrist);
  const Vector3 meeting = 0.5 * (slap[1].wrist.position + slap[3].wrist.position);
  const Pose stop = at(place, Quaternion::Identity(), {meeting, slap[1].wrist.orientation});
  const Vector3 up(0.0, 0.0, 0.2), ahead = along * Vector3(0.02, 0.0, 0.0);
  Script script("cube");
  script.then(0.0, at(object, pushes_along_y, nudge.front().wrist), relaxed_posture());
  script.then(1.0, ready, pointing_posture()).then(6.0, pushed, pointing_posture());
  script.then(0.3, ready, pointing_posture()).then(0.4, shifted(ready, up), flat_posture());
  script.then(0.5, shifted(stop, up + 2.5 * ahead), flat_posture())
      .then(0.4, shifted(stop, ahead), flat_posture());
  script.hold(3.0).then(0.6, shifted(stop, up + ahead), relaxed_posture());
  return script.motion().keyframes;
}

}  // namespace

std::vector<Keyframe> hatch_motion(Skilled skill) {
  constexpr double kLatch = 5.0, kByTheHandle = 8.8;  // parts of open_hatch: each latch, the handle [s]
  const std::vector<Keyframe> open = make_motion("open_hatch").keyframes;
  switch (skill) {
    case Skilled::pull_hatch:
      return last(open, kByTheHandle);
    case Skilled::close_hatch:
      return until(backwards(open), kByTheHandle);
    case Skilled::top_latch:
      return until(open, kLatch);
    case Skilled::bottom_latch:
      return last(until(open, 2.0 * kLatch), kLatch);
    default:
      return open;
  }
}

OperatorSkill beginner_skill() {
  return skill_of(&Figure::beginner);
}

OperatorSkill draw_skill(const std::string& group, std::uint64_t seed) {
  if (group != "beginner" && group != "veteran")
    throw std::invalid_argument("group '" + group + "' is not known: use one of beginner, veteran");
  OperatorSkill skill = skill_of(group == "beginner" ? &Figure::beginner : &Figure::veteran);
  Random random(seed);
  for (const Figure& figure : kFigures)
    if (figure.personal)
      skill.*figure.value *= std::min(kMaxFactor, std::max(kMinFactor, 1.0 + kSpread * random.gaussian()));
  return skill;
}

Tremor::Tremor(double rms, Random& random) {
  constexpr int kWaves = 3;
  for (int i = 0; i < kWaves; ++i) {
    const double frequency = 8.0 + 4.0 * random.uniform(), phase = 2.0 * M_PI * random.uniform();
    waves_.push_back({frequency, phase, random.gaussian_vector(rms * std::sqrt(2.0 / kWaves))});
  }
}

Vector3 Tremor::at(double time) const {
  Vector3 sum = Vector3::Zero();
  for (const Wave& wave : waves_)
    sum += std::sin(2.0 * M_PI * wave.frequency * time + wave.phase) * wave.amplitude;
  return sum;
}

Pose expected(const Pose& pose, const Twist& twist, double seconds) {
  return {pose.position + seconds * twist.linear,
          (rotation_by(seconds * twist.angular) * pose.orientation).normalized()};
}

bool Person::remember(const Moment& now) {
  const double latest = now.time - skill_.reaction_time;
  past_.push_back(now);
  while (past_.size() > 1 && past_[1].time <= latest) past_.pop_front();
  return past_.front().time <= latest;
}

PractisedPerson::PractisedPerson(const OperatorSkill& skill, std::vector<std::optional<PractisedGoal>> goals,
                                 const Body& object, std::uint64_t seed)
    : Person(skill, seed),
      goals_(std::move(goals)),
      object_(object),
      now_{hand_pose(scene_object() + kWaitingOffset, Vector3::UnitY(), Vector3::UnitZ()),
           relaxed_posture()} {}

HandPlace PractisedPerson::move(double time, const Sight& sight) {
  const bool busy = !keyframes_.empty() && time < began_ + keyframes_.back().time;
  if (!busy && !looked_) looked_ = Moment{time, sight};
  if (!busy && looked_ && time >= looked_->time + skill_.reaction_time) {
    look(time, *looked_);
    looked_.reset();
  }
  if (!keyframes_.empty()) now_ = hand_at(keyframes_, time - began_);
  HandPlace place = now_;
  place.wrist.position += tremor_.at(time);
  return place;
}

bool PractisedPerson::ready(const PractisedGoal& goal, const Sight& sight) const {
  return goal.skill == Skilled::catch_ball ? sight.twist.linear.y() < -kMaxTargetSpeed
                                           : sight.twist.linear.norm() < kMaxTargetSpeed;
}

/// Moves the hand to the start of the motion, waits for its time, and performs it.
void PractisedPerson::look(double time, const Moment& seen) {
  const std::size_t goal = seen.sight.goal;
  if (goal >= goals_.size() || !goals_[goal] || !ready(*goals_[goal], seen.sight)) return;
  double begin = time + paced(kPreparationTime);
  const std::vector<Keyframe> does =
      shifted(motion(*goals_[goal], seen, begin), random_.gaussian_vector(skill_.placing_error));
  const double earliest = time + paced(kPreparationTime);
  if (begin < earliest) return;
  keyframes_ = {{0.0, now_.wrist, now_.posture}};
  for (Keyframe key : does) {
    key.time += begin - time;
    keyframes_.push_back(key);
  }
  began_ = time;
}

std::vector<Keyframe> PractisedPerson::motion(const PractisedGoal& goal, const Moment& seen,
                                              double& begin) const {
  constexpr double kCube = 0.025;  // [m]
  const Vector3 object = seen.sight.object.position, off = object - scene_object();
  switch (goal.skill) {
    case Skilled::tap:
      return shifted(make_motion("tap").keyframes, off + Vector3(0.0, 0.0, half_height(object_) - kCube));
    case Skilled::slap:
      return shifted(make_motion("slap").keyframes, off);
    case Skilled::nudge:
      return nudge_and_stop(object, goal.place);
    case Skilled::catch_ball: {
      const double flight = object.y() / -seen.sight.twist.linear.y();
      begin = seen.time + flight;
      const Vector3 met = object + flight * seen.sight.twist.linear;
      return shifted(make_motion("catch_ball").keyframes, met - scene_object());
    }
    case Skilled::press_button:
      return shifted(make_motion("press_button").keyframes, Vector3(0.0, 0.0, 0.17 - 0.36));
    default:
      return hatch_motion(goal.skill);
  }
}

}  // namespace mrhi
