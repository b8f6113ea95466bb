#pragma once

#include <array>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// Triangles with outward normals (counter-clockwise seen from outside) [m].
struct TriangleMesh {
  std::vector<Vector3> vertices;
  std::vector<std::array<int, 3>> triangles;
};

struct Sphere {
  double radius;  ///< [m]
};
struct Box {
  Vector3 half_extents;  ///< [m]
};
/// Axis along z, centred at the origin, flat caps.
struct Cylinder {
  double radius;       ///< [m]
  double half_length;  ///< [m]
};
struct Mesh {
  std::shared_ptr<const TriangleMesh> triangles;  ///< scaled, in the shape's frame
  std::string uri;                                ///< for display: as the URDF has it, a path made file://
  Vector3 scale = Vector3::Ones();
};

using Shape = std::variant<Sphere, Box, Cylinder, Mesh>;

/// A collision shape and its place in the body frame.
struct PlacedShape {
  Shape shape;
  Pose pose;
};

/// A shape to look at and its place in the body frame.
struct Visual {
  Shape shape;
  Pose pose;
  std::array<float, 4> rgba{{0.7f, 0.7f, 0.7f, 1.0f}};
  bool has_color = false;  ///< given; a mesh without one keeps its file's materials
};

/// Radius of the smallest sphere around the shape frame's origin that holds the shape [m].
double bounding_radius(const Shape& shape);

}  // namespace mrhi
