#include "mr_hand_interaction/scene/joint.h"

#include <algorithm>
#include <map>
#include <stdexcept>

#include "../text/text.h"
#include "limits.h"
#include "mr_hand_interaction/scene/scene.h"

namespace mrhi {
namespace {

using namespace joint_ranges;

[[noreturn]] void refuse(const Joint& joint, const std::string& what, const std::string& allowed) {
  throw std::invalid_argument("joint " + text::quoted(joint.name) + ": " + what + "; allowed: " + allowed);
}

void check(const Joint& joint, const std::string& what, double value, const Range& allowed) {
  if (!allowed.contains(value)) refuse(joint, what + " " + text::number(value), allowed.describe());
}

void check_limits(const Joint& joint) {
  if (joint.lower > -Joint::kUnlimited) check(joint, "lower limit", joint.lower, kCoordinate);
  if (joint.upper < Joint::kUnlimited) check(joint, "upper limit", joint.upper, kCoordinate);
  if (!(joint.lower < joint.upper)) {
    refuse(joint,
           "lower limit " + text::number(joint.lower) + " and upper limit " + text::number(joint.upper),
           "lower below upper");
  }
  check(joint, "start", joint.start, kCoordinate);
  if (joint.start < joint.lower || joint.start > joint.upper)
    refuse(joint, "start " + text::number(joint.start), "a place between its limits");
  check(joint, "restitution", joint.restitution, kRestitution);
}

void check_detents(const Joint& joint) {
  if (!joint.detents) return;
  const std::vector<double>& at = joint.detents->at;
  if (at.size() < 2 || at.size() > kMaxDetents)
    refuse(joint, std::to_string(at.size()) + " detents", "2 to " + std::to_string(kMaxDetents));
  for (const double place : at) check(joint, "detent at", place, kCoordinate);
  for (std::size_t i = 1; i < at.size(); ++i) {
    if (!(at[i] - at[i - 1] >= kMinDetentDistance))
      refuse(joint, "detents that do not ascend",
             "each at least " + text::number(kMinDetentDistance) + " further");
  }
  check(joint, "detents' force", joint.detents->force, kForce);
}

void check_forces(const Joint& joint) {
  check(joint, "damping", joint.damping, kForce);
  check(joint, "friction", joint.friction, kForce);
  if (joint.spring) {
    check(joint, "spring's stiffness", joint.spring->stiffness, kStiffness);
    check(joint, "spring's rest", joint.spring->rest, kCoordinate);
  }
  if (!joint.latch) return;
  check(joint, "latch at", joint.latch->at, kCoordinate);
  check(joint, "latch's force", joint.latch->force, kForce);
  check(joint, "latch's reach", joint.latch->reach, kLatchReach);
}

void check_axis(const Joint& joint) {
  if (joint.axis.allFinite() && std::abs(joint.axis.norm() - 1.0) <= 1e-9) return;
  refuse(joint, "axis " + text::vector(joint.axis), "a unit vector");
}

void check_bodies(const Scene& scene, const Joint& joint) {
  const auto bodies = static_cast<int>(scene.bodies.size());
  if (joint.child < 0 || joint.child >= bodies || joint.parent < Joint::kWorld || joint.parent >= bodies)
    refuse(joint, "a body that is not there", "the scene's");
  if (scene.bodies[joint.child].fixed) {
    refuse(joint, "moves the fixture '" + scene.bodies[joint.child].name + "'", "a body that is no fixture");
  }
}

void check_only_joint(const Scene& scene, const Joint& joint) {
  if (joint_of(scene, joint.child) == &joint) return;
  refuse(joint, "is a second one of body '" + scene.bodies[joint.child].name + "'", "one joint to each body");
}

/// Number of joints above this one. Refuses a loop.
std::size_t depth_of(const Scene& scene, const Joint& joint) {
  std::size_t depth = 0;
  const Joint* above = &joint;
  while ((above = joint_of(scene, above->parent)) != nullptr)
    if (++depth > scene.joints.size()) refuse(joint, "hangs in a loop of joints", "trees");
  return depth;
}

/// Limits the number of joints that a force on one of them may move: those of a mechanism, which are solved
/// together. A mechanism begins at a joint on the world or a fixture, or at a free body.
void check_mechanism_sizes(const Scene& scene) {
  std::map<std::string, std::size_t> together;
  for (const Joint& joint : scene.joints) {
    const Joint* first = &joint;  // of the chain to this one: on the world, a fixture or a free body
    while (const Joint* above = joint_of(scene, first->parent)) first = above;
    const Body* const parent = first->parent == Joint::kWorld ? nullptr : &scene.bodies[first->parent];
    const bool floats = parent != nullptr && !parent->fixed;
    const std::string which = floats ? "body '" + parent->name + "'" : "joint " + text::quoted(first->name);
    if (++together[which] > kMaxConnectedJoints) {
      throw std::invalid_argument(
          "the mechanism of " + which + " has more than " + std::to_string(kMaxConnectedJoints) +
          " joints; allowed: at most that, and " + std::to_string(kMaxJoints) + " in a scene");
    }
  }
}

}  // namespace

const Joint* joint_of(const Scene& scene, int body) {
  for (const Joint& joint : scene.joints)
    if (joint.child == body) return &joint;
  return nullptr;
}

// S = (a, 0) of a sliding joint, (0, a) of a turning one.
Twist unit_twist(const Joint& joint, const Quaternion& frame) {
  const Vector3 axis = frame * joint.axis, none = Vector3::Zero();
  return joint.turns() ? Twist{none, axis} : Twist{axis, none};
}

// exp(q S)
Pose joint_motion(const Joint& joint, double position) {
  if (joint.turns()) return {Vector3::Zero(), Quaternion(Eigen::AngleAxisd(position, joint.axis))};
  return {position * joint.axis, Quaternion::Identity()};
}

void arrange_joints(Scene& scene) {
  if (scene.joints.size() > kMaxJoints) {
    throw std::invalid_argument(std::to_string(scene.joints.size()) + " joints; allowed: at most " +
                                std::to_string(kMaxJoints));
  }
  for (const Joint& joint : scene.joints) {
    check_bodies(scene, joint);
    check_axis(joint);
    check_limits(joint);
    check_forces(joint);
    check_detents(joint);
  }
  for (const Joint& joint : scene.joints) {
    check_only_joint(scene, joint);
    depth_of(scene, joint);  // refuses loops
  }
  check_mechanism_sizes(scene);
  std::vector<Joint> sorted = scene.joints;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&](const Joint& a, const Joint& b) { return depth_of(scene, a) < depth_of(scene, b); });
  scene.joints = std::move(sorted);
  for (const Joint& joint : scene.joints) {
    Body& child = scene.bodies[joint.child];
    Pose parent;
    if (joint.parent != Joint::kWorld) {
      Body& body = scene.bodies[joint.parent];
      body.flies = false;
      parent = body.start;
    }
    child.flies = false;
    child.start = parent * joint.in_parent * joint_motion(joint, joint.start) * joint.in_child.inverse();
    child.start.orientation.normalize();
  }
}

std::optional<int> floating_root(const Scene& scene, int body) {
  while (const Joint* joint = joint_of(scene, body)) {
    if (joint->parent == Joint::kWorld) return {};
    body = joint->parent;
  }
  if (scene.bodies[body].fixed) return {};
  return body;
}

}  // namespace mrhi
