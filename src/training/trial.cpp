#include "mr_hand_interaction/training/trial.h"

#include <algorithm>
#include <cmath>

#include "mr_hand_interaction/scene/scene.h"

namespace mrhi {
namespace {

/// Time without contact that ends a touch, and time not held that is a drop [ns].
constexpr Nanoseconds kTouchEndTime = 100'000'000;
constexpr Nanoseconds kDropTime = 100'000'000;

Nanoseconds nanoseconds(double seconds) {
  return static_cast<Nanoseconds>(std::llround(1e9 * seconds));
}

/// Angle between the orientation and the goal's, or between their axes if the goal has one [rad].
double misalignment(const Goal& goal, const Quaternion& orientation) {
  if (!goal.axis) return orientation.angularDistance(goal.orientation);
  const double cosine = (orientation * *goal.axis).dot(goal.orientation * *goal.axis);
  return std::acos(std::min(1.0, std::abs(cosine)));
}

bool has_orientation(const Goal& goal, const Quaternion& orientation) {
  return !goal.angle_tolerance || misalignment(goal, orientation) <= *goal.angle_tolerance;
}

/// The body of a goal `rest`; nothing if it needs an operator and there is none.
std::optional<OperatorMotion> resting_body(const Goal& goal, const Observation& seen) {
  return goal.of_operator ? seen.person : OperatorMotion{seen.pose, seen.twist};
}

bool is_at_rest(const Goal& goal, const Observation& seen) {
  const std::optional<OperatorMotion> body = resting_body(goal, seen);
  return body && (body->pose.position - goal.position).norm() <= goal.tolerance &&
         has_orientation(goal, body->pose.orientation) && body->twist.linear.norm() <= goal.max_speed &&
         body->twist.angular.norm() <= goal.max_spin;
}

bool in_box(const Goal& goal, const Vector3& position) {
  return ((position - goal.position).array().abs() <= 0.5 * goal.size.array()).all();
}

/// True if the goal requires a hand that holds the object.
bool requires_grasp(GoalKind kind) {
  return kind == GoalKind::pick || kind == GoalKind::place || kind == GoalKind::insert ||
         kind == GoalKind::catch_it;
}

/// True if the goal requires a touch without a grasp.
bool requires_touch(GoalKind kind) {
  return kind == GoalKind::nudge_into || kind == GoalKind::strike;
}

/// True if the goal's condition holds now. `start` is the object's position as the trial began. For kinds
/// with a lasting condition: pick, place, insert, catch_it, nudge_into, joint, rest.
bool is_met(const Goal& goal, const Observation& seen, const Vector3& start) {
  const Vector3& position = seen.pose.position;
  switch (goal.kind) {
    case GoalKind::pick:
      return seen.held && (position - start).norm() >= goal.distance;
    case GoalKind::place:
    case GoalKind::insert:
      return seen.held && (position - goal.position).norm() <= goal.tolerance &&
             has_orientation(goal, seen.pose.orientation);
    case GoalKind::catch_it:
      return seen.held;
    case GoalKind::nudge_into:
      return !seen.held && in_box(goal, position) && seen.twist.linear.norm() <= goal.max_speed;
    case GoalKind::joint:
      return std::any_of(seen.joints.begin(), seen.joints.end(), [&goal](const auto& joint) {
        return joint.first == goal.joint && joint.second >= goal.above && joint.second <= goal.below;
      });
    case GoalKind::rest:
      return is_at_rest(goal, seen);
    case GoalKind::strike:
    case GoalKind::release:
      break;
  }
  return false;
}

}  // namespace

const char* to_string(TrialResult result) {
  static const char* const names[] = {"none", "completed", "skipped", "timed_out", "aborted"};
  return names[static_cast<std::size_t>(result)];
}

const char* to_string(TrialEventKind kind) {
  static const char* const names[] = {"begun",   "grasped",       "dropped",       "released",
                                      "reached", "left",          "goal_achieved", "touched",
                                      "missed",  "tracking_lost", "put_back",      "ended"};
  return names[static_cast<std::size_t>(kind)];
}

void Trial::update(const Observation& seen) {
  events_.clear();
  if (result_ != TrialResult::none || (last_ && seen.stamp <= last_->stamp)) return;
  const Nanoseconds passed = counting_ ? seen.stamp - last_->stamp : 0;
  stamp_ = seen.stamp;
  before_ = elapsed_;
  elapsed_ += passed;
  counting_ = true;
  if (!released_) stage_elapsed_[static_cast<std::size_t>(stage())] += passed;
  if (!last_) {
    start_ = seen.pose.position;
    add(TrialEventKind::begun);
  }
  measure(seen, passed);
  note_grasp(seen);
  note_touch(seen, passed);
  if (current_goal().kind == GoalKind::release) {
    release(seen);
  } else if (current_goal().kind == GoalKind::strike) {
    strike(seen);
  } else {
    hold(seen, passed);
  }
  if (!released_ && result_ == TrialResult::none && elapsed_ >= nanoseconds(task_->time_out))
    finish(TrialResult::timed_out);
  last_ = seen;
}

void Trial::measure(const Observation& seen, Nanoseconds passed) {
  for (int i = 0; i < seen.tracking_losses; ++i) add(TrialEventKind::tracking_lost);
  measures_.tracking_losses += seen.tracking_losses;
  if (seen.put_back) add(TrialEventKind::put_back);
  measures_.touches += seen.touches;
  if (seen.person) {
    measures_.operator_speed = seen.person->twist.linear.norm();
    measures_.operator_spin = seen.person->twist.angular.norm();
  }
  if (!seen.held || !last_ || !last_->held || seen.put_back) return;
  measures_.path_length += (seen.pose.position - last_->pose.position).norm();
  if (!seen.grip_force) return;
  gripped_ += passed;
  grip_impulse_ += *seen.grip_force * to_seconds(passed);
  measures_.grip_force_max = std::max(measures_.grip_force_max.value_or(0.0), *seen.grip_force);
}

/// A grasp that breaks off and is there again at once has lost nothing.
void Trial::note_grasp(const Observation& seen) {
  const bool held_before = last_ && last_->held;
  if (!requires_grasp(current_goal().kind)) ungrasped_since_.reset();
  if (seen.held) {
    if (!held_before && !ungrasped_since_) {
      add(TrialEventKind::grasped);
      measures_.attempts += !requires_touch(current_goal().kind);
    }
    ungrasped_since_.reset();
  } else if (held_before && requires_grasp(current_goal().kind)) {
    ungrasped_since_ = elapsed_;
  }
  if (!ungrasped_since_ || (elapsed_ - *ungrasped_since_ < kDropTime && !seen.put_back)) return;
  ungrasped_since_.reset();
  add(TrialEventKind::dropped);
  note_drop();
}

void Trial::note_touch(const Observation& seen, Nanoseconds passed) {
  untouched_ = seen.touched ? 0 : untouched_ + passed;
  if (seen.touched && !touching_ && requires_touch(current_goal().kind)) {
    add(TrialEventKind::touched);
    ++measures_.attempts;
  }
  if (seen.touched) touching_ = true;
}

void Trial::hold(const Observation& seen, Nanoseconds passed) {
  const Goal& goal = current_goal();
  const bool met = is_met(goal, seen, start_);
  if (met && inside_) timer_ += passed;
  if (met && !inside_) add(TrialEventKind::reached, static_cast<double>(goal_ + 1));
  if (!met && inside_) {
    add(TrialEventKind::left, to_seconds(timer_));
    if (goal.leaving == Leaving::reset) timer_ = 0;
  }
  inside_ = met;
  const bool achieved = met && timer_ >= nanoseconds(goal.hold);
  if (goal.kind == GoalKind::rest) note_rest(seen, achieved);
  if (untouched_ >= kTouchEndTime) touching_ = false;
  if (achieved) {
    achieve();
  } else if (too_late()) {
    finish(TrialResult::timed_out);
  }
}

bool Trial::too_late() const {
  const Goal& goal = current_goal();
  if (!goal.within) return false;
  const Nanoseconds within = nanoseconds(*goal.within);
  if (goal.kind == GoalKind::joint) return !inside_ && elapsed_ - goal_begun_ > within;
  return measures_.attempts == 0 && elapsed_ > within;
}

void Trial::strike(const Observation& seen) {
  if (!touching_ || untouched_ < kTouchEndTime) return;
  touching_ = false;
  const double speed = seen.twist.linear.norm();
  if (speed >= current_goal().min_speed && speed <= current_goal().max_speed) {
    achieve();
  } else {
    add(TrialEventKind::missed, speed);
    note_drop();
  }
}

void Trial::note_drop() {
  ++measures_.drops;
  measures_.manipulation_drops += stage() == TrainingStage::manipulation;
}

void Trial::release(const Observation& seen) {
  if (seen.held) {
    if (released_) stage_elapsed_[static_cast<std::size_t>(stage())] += elapsed_ - released_->elapsed;
    released_.reset();  // taken again: it was not released
    return;
  }
  const Nanoseconds drift_time = nanoseconds(current_goal().drift_time);
  if (!released_) {
    add(TrialEventKind::released);
    released_ = ReleaseStart{elapsed_, seen.pose.position};
    measures_.release_speed = seen.twist.linear.norm();
  } else if (seen.put_back || elapsed_ - released_->elapsed >= drift_time) {
    const Vector3 end =
        seen.put_back ? last_->pose.position : position_at(released_->elapsed + drift_time, seen);
    measures_.release_drift = (end - released_->position).norm();
    achieve();
  }
}

Vector3 Trial::position_at(Nanoseconds elapsed, const Observation& seen) const {
  if (elapsed_ == before_) return seen.pose.position;
  const double share = to_seconds(elapsed - before_) / to_seconds(elapsed_ - before_);
  return last_->pose.position + share * (seen.pose.position - last_->pose.position);
}

void Trial::achieve() {
  add(TrialEventKind::goal_achieved, static_cast<double>(goal_ + 1));
  timer_ = 0;
  if (goal_ + 1 == task_->goals.size()) {
    finish(TrialResult::completed);
    return;
  }
  inside_ = arrived_ = false;
  goal_begun_ = elapsed_;
  ++goal_;
}

void Trial::end(TrialResult result) {
  events_.clear();
  if (result_ == TrialResult::none) finish(result);
}

void Trial::finish(TrialResult result) {
  result_ = result;
  measures_.completion_time = to_seconds(released_ ? released_->elapsed : elapsed_);
  for (std::size_t i = 0; i <= static_cast<std::size_t>(stage()); ++i) {
    const bool has = std::any_of(task_->goals.begin(), task_->goals.end(),
                                 [i](const Goal& goal) { return static_cast<std::size_t>(goal.stage) == i; });
    if (has) measures_.stage_times[i] = to_seconds(stage_elapsed_[i]);
  }
  if (gripped_ > 0) measures_.grip_force_mean = grip_impulse_ / to_seconds(gripped_);
  add(TrialEventKind::ended);
}

double Trial::progress() const {
  if (result_ == TrialResult::completed) return 1.0;
  const double duration = timed();
  return duration > 0.0 ? 1.0 - remaining() / duration : 0.0;
}

double Trial::timed() const {
  return current_goal().kind == GoalKind::release ? current_goal().drift_time : current_goal().hold;
}

double Trial::remaining() const {
  if (result_ == TrialResult::completed) return 0.0;
  return std::max(0.0, timed() - to_seconds(released_ ? elapsed_ - released_->elapsed : timer_));
}

void Trial::add(TrialEventKind kind, double detail) {
  events_.push_back({stamp_, stage(), kind, detail});
}

Observation observe(const Simulation& simulation, std::size_t body) {
  const FrameResult& result = simulation.result();
  const BodyState& state = simulation.state().bodies[body];
  Observation seen;
  seen.stamp = result.stamp;
  seen.pose = state.pose;
  seen.twist = twist_of(simulation.scene().bodies[body], state);
  const std::vector<std::size_t> parts = hanging_on(body, simulation.scene());
  const auto is_part = [&](int b) {
    return std::find(parts.begin(), parts.end(), static_cast<std::size_t>(b)) != parts.end();
  };
  seen.held = std::any_of(parts.begin(), parts.end(),
                          [&](std::size_t part) { return is_held(part, simulation.state()); });
  double normal_force = 0.0;
  for (const Contact& contact : result.contacts) {
    if (!is_part(contact.key.body)) continue;
    seen.touched = true;
    normal_force += std::max(0.0, -contact.normal.dot(contact.force));
  }
  seen.grip_force = 0.5 * normal_force;
  if (const std::vector<Operator>& operators = simulation.scene().operators; !operators.empty()) {
    const auto b = static_cast<std::size_t>(operators.front().body);
    const BodyState& person = simulation.state().bodies[b];
    seen.person = OperatorMotion{person.pose, twist_of(simulation.scene().bodies[b], person)};
  }
  for (const Event& event : result.events) {
    seen.touches += event.kind == EventKind::contact_begin;
    seen.tracking_losses += event.kind == EventKind::hand_lost;
    seen.put_back |= event.kind == EventKind::out_of_bounds && is_part(event.body);
  }
  const std::vector<Joint>& joints = simulation.scene().joints;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (is_part(joints[j].child))
      seen.joints.emplace_back(joints[j].name, simulation.state().joints[j].position);
  }
  return seen;
}

void Trial::note_rest(const Observation& seen, bool achieved) {
  const Goal& goal = current_goal();
  const std::optional<OperatorMotion> body = resting_body(goal, seen);
  if (!body || !std::isfinite(goal.tolerance)) return;
  const double distance = (body->pose.position - goal.position).norm();
  if (!arrived_ && distance <= goal.tolerance) {
    arrived_ = true;
    measures_.arrival_speed = body->twist.linear.norm();
  }
  if (!achieved) return;
  measures_.misplacement = distance;
  if (goal.angle_tolerance) measures_.misalignment = misalignment(goal, body->pose.orientation);
}

}  // namespace mrhi
