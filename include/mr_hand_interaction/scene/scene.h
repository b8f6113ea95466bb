#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/scene/body.h"
#include "mr_hand_interaction/scene/joint.h"

namespace mrhi {

/// Axis-aligned box in world [m].
struct Bounds {
  Vector3 min{-1.5, -1.5, -1.0};
  Vector3 max{1.5, 1.5, 2.0};
};

/// A mesh file that a scene was made of.
struct SceneFile {
  std::string name;  ///< as the URDF writes it
  std::string path;  ///< where it was read
};

/// A person who floats. Hands with an operator are tracked in the link frame of the operator's body, and what
/// they do to objects and fixtures is done to that body.
struct Operator {
  int body = 0;                  ///< index in Scene::bodies; a body without shapes
  std::optional<int> restraint;  ///< fixture that can hold the operator, index in Scene::bodies
  double reach = 1.5;            ///< of the restraint, to the operator's centre of mass [m]
};

/// A line between a free body and a fixture. It only pulls.
struct Tether {
  int body = 0, fixture = 0;         ///< indices in Scene::bodies
  Vector3 at = Vector3::Zero();      ///< end on the body, body frame [m]
  Vector3 anchor = Vector3::Zero();  ///< end on the fixture, body frame [m]
  double length = 0.0;               ///< largest distance of the ends [m]
};

/// All that exists besides hands. Immutable once loaded.
struct Scene {
  std::string name;
  std::vector<Body> bodies;   ///< free bodies and fixtures, in the URDF's order
  std::vector<Joint> joints;  ///< see arrange_joints()
  std::vector<Operator>
      operators;  ///< hand `id` is of operator id modulo their number; none: hands are in world
  std::vector<Tether> tethers;
  Vector3 gravity = Vector3::Zero();  ///< [m/s^2]
  Bounds bounds;                      ///< a free body whose centre leaves is put back where it started
  std::vector<std::string> warnings;  ///< what the loader assumed or left out, a line each
  std::vector<SceneFile> mesh_files;  ///< each once, in the order in which they were read
};

/// Index of the body of that name, or nothing.
std::optional<int> find_body(const Scene& scene, const std::string& name);

/// Names of the bodies that may have a GraspMode of their own: all but fixtures and the parts of a floating
/// linkage, which has that of the body that it hangs on.
std::vector<std::string> graspable_bodies(const Scene& scene);

/// What holds for a body: its own mode, or that of the floating linkage that it is part of.
GraspMode grasp_of(const Scene& scene, int body);

/// The free body of that name. Throws std::invalid_argument that lists those there are.
Body& free_body(Scene& scene, const std::string& name);

/// Adds the bodies, joints, operators and tethers of `part`. Throws std::invalid_argument for a name that is
/// taken.
void append(const Scene& part, Scene& scene);

/// The body and all that hangs on it by joints, in the scene's order.
std::vector<std::size_t> hanging_on(std::size_t body, const Scene& scene);

/// Takes a body out with all that hangs on it; the joints that are left go on to mean the same bodies.
void remove_body(std::size_t body, Scene& scene);

}  // namespace mrhi
