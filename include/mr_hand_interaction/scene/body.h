#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/scene/shape.h"

namespace mrhi {

/// Contact properties of an object's surface.
struct Material {
  double restitution = 0.3;       ///< epsilon of Newton's impact law (Eq. 10), 0..1
  double static_friction = 0.8;   ///< mu, Coulomb's cone while sticking (Eq. 19)
  double dynamic_friction = 0.6;  ///< phi, while sliding (Eq. 20); at most static_friction
  double stiffness = 100.0;       ///< gamma of the penetration force (Eq. 16) [N/m]
};

/// True for each material property that the scene sets; the others follow the parameters.
struct OwnMaterial {
  bool restitution = false, static_friction = false, dynamic_friction = false, stiffness = false;
};

/// Interaction of hands with a body under `implicit`.
enum class GraspMode : std::uint8_t {
  parameter,  ///< `assist` or `free`, by the parameter contact/grasp_assist
  free,       ///< contacts only
  assist,     ///< contacts and grasp assist
  never       ///< hands may push it, but apply no force while it is between opposing contact groups
};

/// Constant properties of one object. The body frame has its origin at the centre of mass and the axes of the
/// URDF link.
struct Body {
  std::string name;
  bool fixed = false;                     ///< a fixture: immovable; mass and inertia are not used
  bool flies = true;                      ///< neither a fixture nor on a joint: advanced by free flight
  bool is_operator = false;               ///< an operator's body (Scene::operators): contacts ignore it
  double mass = 1.0;                      ///< [kg], > 0
  Matrix3 inertia = Matrix3::Identity();  ///< about the centre of mass, body axes [kg m^2], positive definite
  Matrix3 inverse_inertia = Matrix3::Identity();
  Matrix3 principal_axes = Matrix3::Identity();  ///< of inertia, body axes: a rotation
  Vector3 inverse_moments = Vector3::Ones();     ///< 1 / inertia along each of them [1/(kg m^2)]
  Pose start;                                    ///< of the body frame in world
  Twist start_twist;                             ///< world axes
  Pose link_in_body;  ///< the URDF link's frame in the body frame (rotation is identity)
  Material material;
  OwnMaterial own_material;
  GraspMode grasp = GraspMode::parameter;
  std::vector<PlacedShape> shapes;  ///< for collision
  std::vector<Visual> visuals;
  double bounding_radius = 0.0;  ///< of all shapes, about the body frame's origin [m]
};

/// Names of the modes, for messages.
constexpr const char* kGraspModes = "free, assist or never";

/// Mode by its name in files: free, assist or never. Empty for another name.
std::optional<GraspMode> grasp_mode(const std::string& name);
/// Empty for GraspMode::parameter.
std::string name_of(GraspMode mode);

/// Computes inverse_inertia (zero for a fixture), its principal axes and bounding_radius. Throws
/// std::invalid_argument with the body and the value if a free body's mass or inertia is not positive
/// (definite), or a number exceeds its limits (src/scene/limits.h).
void complete(Body& body);

}  // namespace mrhi
