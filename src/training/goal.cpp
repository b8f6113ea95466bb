#include "goal.h"

#include <algorithm>
#include <cmath>

namespace mrhi {
namespace {

bool lies_as_asked(const Goal& goal, const Quaternion& orientation) {
  if (!goal.angle_tolerance) return true;
  if (!goal.axis) return orientation.angularDistance(goal.orientation) <= *goal.angle_tolerance;
  const double cosine = (orientation * *goal.axis).dot(goal.orientation * *goal.axis);
  return std::acos(std::min(1.0, std::abs(cosine))) <= *goal.angle_tolerance;
}

bool in_box(const Goal& goal, const Vector3& position) {
  return ((position - goal.position).array().abs() <= 0.5 * goal.size.array()).all();
}

}  // namespace

bool asks_to_hold(GoalKind kind) {
  return kind == GoalKind::pick || kind == GoalKind::place || kind == GoalKind::insert ||
         kind == GoalKind::catch_it;
}

bool asks_to_touch(GoalKind kind) {
  return kind == GoalKind::nudge_into || kind == GoalKind::strike;
}

bool is_met(const Goal& goal, const Observation& seen, const Vector3& start) {
  const Vector3& position = seen.pose.position;
  switch (goal.kind) {
    case GoalKind::pick:
      return seen.held && (position - start).norm() >= goal.distance;
    case GoalKind::place:
    case GoalKind::insert:
      return seen.held && (position - goal.position).norm() <= goal.tolerance &&
             lies_as_asked(goal, seen.pose.orientation);
    case GoalKind::catch_it:
      return seen.held;
    case GoalKind::nudge_into:
      return !seen.held && in_box(goal, position) && seen.twist.linear.norm() <= goal.max_speed;
    case GoalKind::joint:
      return std::any_of(seen.joints.begin(), seen.joints.end(), [&goal](const auto& joint) {
        return joint.first == goal.joint && joint.second >= goal.above && joint.second <= goal.below;
      });
    case GoalKind::strike:
    case GoalKind::release:
      break;
  }
  return false;
}

}  // namespace mrhi
