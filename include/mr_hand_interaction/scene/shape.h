#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "mr_hand_interaction/math.h"

namespace mrhi {

struct AxisSpan;
struct Capsule;
struct ClosestFeatures;

/// Of a solid in its frame.
struct SolidMoments {
  double volume = 0.0;               ///< [m^3]
  Vector3 first = Vector3::Zero();   ///< the integral of x over it [m^4]
  Matrix3 second = Matrix3::Zero();  ///< that of x x^T [m^5]
};

/// A solid between two flat ends that are half.z from its middle: on a rectangle, or on a disc of radius
/// half.x.
struct PrismForm {
  Vector3 half;  ///< [m]
  bool round;
};

/// Triangles with outward normals (counter-clockwise seen from outside) [m].
struct TriangleMesh {
  std::vector<Vector3> vertices;
  std::vector<std::array<int, 3>> triangles;
  /// First triangle of each closed part, ascending from 0, of a mesh whose parts may overlap: the solid is
  /// their union. Empty: one part.
  std::vector<int> parts{};
};

// Each shape answers the same questions, in its own frame and in a file of its own
// (src/collision/shape_*.cpp):
//   bounding_radius  of the smallest sphere around the origin that holds it [m]
//   moments          of a solid of its form
//   farthest         its point farthest along n
//   way_out          from `point` along the unit vector `direction` to where that line leaves the shape
//   core             the capsule that it is, if it is one or a ball
//   prism            the prism that it is, if it is one
//   closest          features of a capsule of the hand; anything of a distance beyond `margin` may stand for
//                    what is farther than that
//   span             what of the capsule's axis stands over the flat or straight piece at `features`
// A mesh leaves the last two to its MeshCollider, that is made once.

struct Sphere {
  double radius;  ///< [m]

  double bounding_radius() const { return radius; }
  SolidMoments moments() const;
  Vector3 farthest(const Vector3& n) const;
  std::optional<double> way_out(const Vector3& point, const Vector3& direction) const;
  std::optional<Capsule> core() const;
  std::optional<PrismForm> prism() const { return std::nullopt; }
  ClosestFeatures closest(const Capsule& capsule, double margin) const;
  AxisSpan span(const Capsule& capsule, const ClosestFeatures& features) const;
};

struct Box {
  Vector3 half_extents;  ///< [m]

  double bounding_radius() const { return half_extents.norm(); }
  SolidMoments moments() const;
  Vector3 farthest(const Vector3& n) const;
  std::optional<double> way_out(const Vector3& point, const Vector3& direction) const;
  std::optional<Capsule> core() const;
  std::optional<PrismForm> prism() const { return PrismForm{half_extents, false}; }
  ClosestFeatures closest(const Capsule& capsule, double margin) const;
  AxisSpan span(const Capsule& capsule, const ClosestFeatures& features) const;
};

/// Axis along z, centred at the origin, flat caps.
struct Cylinder {
  double radius;       ///< [m]
  double half_length;  ///< [m]

  double bounding_radius() const;
  SolidMoments moments() const;
  Vector3 farthest(const Vector3& n) const;
  std::optional<double> way_out(const Vector3& point, const Vector3& direction) const;
  std::optional<Capsule> core() const;
  std::optional<PrismForm> prism() const { return PrismForm{{radius, radius, half_length}, true}; }
  ClosestFeatures closest(const Capsule& capsule, double margin) const;
  AxisSpan span(const Capsule& capsule, const ClosestFeatures& features) const;
};

/// A capsule: axis along z, centred at the origin, a half ball on each end.
struct Pill {
  double radius;       ///< [m]
  double half_length;  ///< of the straight part [m]

  double bounding_radius() const { return half_length + radius; }
  SolidMoments moments() const;
  Vector3 farthest(const Vector3& n) const;
  std::optional<double> way_out(const Vector3& point, const Vector3& direction) const;
  std::optional<Capsule> core() const;
  std::optional<PrismForm> prism() const { return std::nullopt; }
  ClosestFeatures closest(const Capsule& capsule, double margin) const;
  AxisSpan span(const Capsule& capsule, const ClosestFeatures& features) const;
};

struct Mesh {
  std::shared_ptr<const TriangleMesh> triangles;  ///< scaled, in the shape's frame
  std::string uri;                                ///< for display: as the URDF has it, a path made file://
  Vector3 scale = Vector3::Ones();

  double bounding_radius() const;
  SolidMoments moments() const;
  Vector3 farthest(const Vector3& n) const;
  std::optional<double> way_out(const Vector3& point, const Vector3& direction) const;
  std::optional<Capsule> core() const;
  std::optional<PrismForm> prism() const { return std::nullopt; }
};

using Shape = std::variant<Sphere, Box, Cylinder, Pill, Mesh>;

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
