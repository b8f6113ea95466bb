#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "mr_hand_interaction/math.h"

namespace mrhi {

struct Scene;

/// The two ways in which a joint moves: about its axis [rad], or along it [m]. What is "/rad" or "N m" below
/// is "/m" or "N" of one that slides.
enum class JointKind : std::uint8_t { turning, sliding };

/// Draws the joint to a place of rest, which may lie beyond its limits.
struct JointSpring {
  double stiffness = 0.0;  ///< [N m/rad]
  double rest = 0.0;       ///< [rad]
};

/// Places that the joint snaps into, each as far as midway to the next one.
struct Detents {
  std::vector<double> at;  ///< ascending [rad]
  double force = 0.0;      ///< that takes it out of the closest ones [N m]
};

/// Holds the joint at one place by up to a force, within a reach; what is drawn further is let go, and is
/// caught when it comes back.
struct Latch {
  double at = 0.0;     ///< [rad]
  double force = 0.0;  ///< most that it holds and draws with [N m]
  double reach = 0.0;  ///< [rad]
};

/// A joint by which a body hangs on another one, on a fixture, or on the world.
struct Joint {
  static constexpr int kWorld = -1;
  static constexpr double kUnlimited = std::numeric_limits<double>::infinity();

  std::string name;
  JointKind kind = JointKind::turning;
  int parent = kWorld;              ///< index in Scene::bodies
  int child = 0;                    ///< likewise: of a body that is no fixture
  Vector3 axis = Vector3::UnitX();  ///< unit, joint's frame, which is the child's link frame
  Pose in_parent;                   ///< of the joint's frame at 0, in the parent's body frame
  Pose in_child;                    ///< of the joint's frame, in the child's body frame
  double start = 0.0;               ///< where it begins [rad]
  double lower = -kUnlimited;       ///< [rad]
  double upper = kUnlimited;        ///< [rad]
  double restitution = 0.0;         ///< of the limits, 0..1
  double damping = 0.0;             ///< viscous [N m s/rad]
  double friction = 0.0;            ///< Coulomb's, static as sliding [N m]
  std::optional<JointSpring> spring;
  std::optional<Detents> detents;
  std::optional<Latch> latch;

  bool is_limited() const { return lower > -kUnlimited || upper < kUnlimited; }
};

/// Of the child's link frame, which is the joint's, against its frame at 0.
Pose joint_motion(const Joint& joint, double position);

/// Puts the start poses of all bodies that hang on joints where the joints' starts have them, and the joints
/// in an order in which a body's own comes before those of what hangs on it. Throws std::invalid_argument
/// with one line for a joint that has no place in a tree: a loop, two joints to one body, a fixture as child,
/// a parent that is not there, numbers out of their limits.
void arrange_joints(Scene& scene);

/// The free body that a body hangs on through joints, or the body itself if it is free. Nothing for a fixture
/// and for what hangs on a fixture or on the world.
std::optional<int> floating_root(const Scene& scene, int body);

/// Index of the joint of that name, or nothing.
std::optional<int> find_joint(const Scene& scene, const std::string& name);

}  // namespace mrhi
