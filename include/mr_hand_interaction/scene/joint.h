#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "mr_hand_interaction/math.h"

namespace mrhi {

struct Scene;

/// Motion of a joint: rotation about its axis [rad], or translation along it [m]. For a sliding joint, units
/// of "/rad" and "N m" below are "/m" and "N".
enum class JointKind : std::uint8_t { turning, sliding };

/// Spring towards a rest position, which may lie beyond the joint's limits.
struct JointSpring {
  double stiffness = 0.0;  ///< [N m/rad]
  double rest = 0.0;       ///< [rad]
};

/// Positions into which the joint snaps; each attracts up to midway to the next one.
struct Detents {
  std::vector<double> at;  ///< ascending [rad]
  double force = 0.0;      ///< force to leave the detents that are closest together [N m]
};

/// Holds the joint at one position, up to a force and within a capture range. A joint pulled further is
/// released, and captured again when it returns.
struct Latch {
  double at = 0.0;     ///< [rad]
  double force = 0.0;  ///< maximum holding force [N m]
  double reach = 0.0;  ///< capture range [rad]
};

/// A joint between a body and its parent: another body, a fixture, or the world.
struct Joint {
  static constexpr int kWorld = -1;
  static constexpr double kUnlimited = std::numeric_limits<double>::infinity();

  std::string name;
  JointKind kind = JointKind::turning;
  int parent = kWorld;              ///< index in Scene::bodies
  int child = 0;                    ///< likewise; not a fixture
  Vector3 axis = Vector3::UnitX();  ///< unit, joint's frame, which is the child's link frame
  Pose in_parent;                   ///< joint frame at position 0, in the parent's body frame
  Pose in_child;                    ///< joint frame, in the child's body frame
  double start = 0.0;               ///< initial position [rad]
  double lower = -kUnlimited;       ///< [rad]
  double upper = kUnlimited;        ///< [rad]
  double restitution = 0.0;         ///< of the limits, 0..1
  double damping = 0.0;             ///< viscous [N m s/rad]
  double friction = 0.0;            ///< Coulomb friction, static and sliding alike [N m]
  std::optional<JointSpring> spring;
  std::optional<Detents> detents;
  std::optional<Latch> latch;

  bool is_limited() const { return lower > -kUnlimited || upper < kUnlimited; }
  bool turns() const { return kind == JointKind::turning; }
  const char* kind_name() const { return turns() ? "turning" : "sliding"; }
  const char* unit() const { return turns() ? "rad" : "m"; }  ///< of its position
};

/// Motion subspace: twist of the joint's frame, which has this orientation, for unit velocity of the joint.
Twist unit_twist(const Joint& joint, const Quaternion& frame);

/// Pose of the joint's frame, which is the child's link frame, relative to its pose at position 0.
Pose joint_motion(const Joint& joint, double position);

/// Sets the start poses of all jointed bodies from the joints' start positions. Sorts the joints: a body's
/// own precedes those of its children. Throws std::invalid_argument with one line for joints that form no
/// tree: a loop, two joints to one body, a fixture as child, an unknown parent, or numbers out of their
/// limits.
void arrange_joints(Scene& scene);

/// The free body at the root of a body's linkage; the body itself if it is free. Empty for fixtures and for
/// bodies jointed to a fixture or to the world.
std::optional<int> floating_root(const Scene& scene, int body);

/// Index of the joint of that name, or empty.
std::optional<int> find_joint(const Scene& scene, const std::string& name);

}  // namespace mrhi
