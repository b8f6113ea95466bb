#pragma once

#include <string>
#include <vector>

#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/scene/material.h"
#include "mr_hand_interaction/scene/shape.h"

namespace mrhi {

/// What does not change about one object. The body frame has its origin at the centre of mass and the axes of
/// the URDF link.
struct Body {
  std::string name;
  bool fixed = false;                     ///< a fixture: never moves, mass and inertia are not used
  bool flies = true;                      ///< neither a fixture nor on a joint: moves by itself
  bool is_operator = false;               ///< an operator's body (Scene::operators): nothing touches it
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
  std::vector<PlacedShape> shapes;  ///< for collision
  std::vector<Visual> visuals;
  double bounding_radius = 0.0;  ///< of all shapes, about the body frame's origin [m]
};

/// Fills inverse_inertia (zero for a fixture), its principal axes and bounding_radius from the rest. Throws
/// std::invalid_argument naming the body and the value if a free body's mass or inertia is not positive
/// (definite), or a number is beyond its limits (src/scene/limits.h).
void complete(Body& body);

}  // namespace mrhi
