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

  bool contains(const Vector3& place) const {
    return (place.array() >= min.array()).all() && (place.array() <= max.array()).all();
  }
};

/// A mesh file used by a scene, or a file that it names, such as the buffer of a glTF.
struct SceneFile {
  std::string name;  ///< as in the URDF; of a named file: in the mesh's folder
  std::string path;  ///< path from which it was read
};

/// A floating person. Hands with an operator are tracked in the link frame of the operator's body, which
/// receives the reactions of their contacts.
struct Operator {
  int body = 0;                  ///< index in Scene::bodies; a body without shapes
  std::optional<int> restraint;  ///< fixture that can restrain the operator, index in Scene::bodies
  double reach = 1.5;            ///< range of the restraint, to the operator's centre of mass [m]
};

/// A line between a free body and a fixture, which only pulls.
struct Tether {
  int body = 0, fixture = 0;         ///< indices in Scene::bodies
  Vector3 at = Vector3::Zero();      ///< end on the body, body frame [m]
  Vector3 anchor = Vector3::Zero();  ///< end on the fixture, body frame [m]
  double length = 0.0;               ///< largest distance between the ends [m]
};

/// Everything except hands. Immutable once loaded.
struct Scene {
  std::string name;
  std::vector<Body> bodies;   ///< free bodies and fixtures, in the URDF's order
  std::vector<Joint> joints;  ///< see arrange_joints()
  std::vector<Operator>
      operators;  ///< hand `id` belongs to operator id modulo their number; none: hands are in world
  std::vector<Tether> tethers;
  Vector3 gravity = Vector3::Zero();  ///< [m/s^2]
  Bounds bounds;                      ///< a free body whose centre leaves these is reset to its start pose
  std::vector<std::string> warnings;  ///< assumptions and omissions of the loader, one line each
  std::vector<SceneFile> mesh_files;  ///< each once, in the order of reading
};

/// Index of the body of that name, or empty.
std::optional<int> find_body(const Scene& scene, const std::string& name);

/// Names of the bodies that may have a GraspMode of their own: all but fixtures and the children of a
/// floating linkage, which have that of its root.
std::vector<std::string> graspable_bodies(const Scene& scene);

/// Effective mode of a body: its own, or that of its floating linkage's root.
GraspMode grasp_of(const Scene& scene, int body);

/// The free body of that name. Throws std::invalid_argument that lists the known names.
Body& free_body(Scene& scene, const std::string& name);

/// Adds the bodies, joints, operators and tethers of `part`. Throws std::invalid_argument if a name is in
/// use.
void append(const Scene& part, Scene& scene);

/// The body and its descendants by joints, in the scene's order.
std::vector<std::size_t> hanging_on(std::size_t body, const Scene& scene);

/// Removes a body and its descendants. The indices of the remaining joints are updated.
void remove_body(std::size_t body, Scene& scene);

}  // namespace mrhi
