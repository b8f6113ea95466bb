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

/// Volume moments of a solid in its frame.
struct SolidMoments {
  double volume = 0.0;               ///< [m^3]
  Vector3 first = Vector3::Zero();   ///< integral of x over the solid [m^4]
  Matrix3 second = Matrix3::Zero();  ///< integral of x x^T over the solid [m^5]
};

/// A prism with flat ends at half.z from its centre, on a rectangle or on a disc of radius half.x.
struct PrismForm {
  Vector3 half;  ///< [m]
  bool round;
};

/// Triangles with outward normals (counter-clockwise seen from outside) [m].
struct TriangleMesh {
  std::vector<Vector3> vertices;
  std::vector<std::array<int, 3>> triangles;
  /// First triangle of each closed part, ascending from 0, if parts may overlap: the solid is their union.
  /// Empty: one part.
  std::vector<int> parts{};
};

// Queries of each shape, in its own frame; each shape has a file of its own (src/collision/shape_*.cpp):
//    bounding_radius  of the smallest sphere around the origin that contains it [m]
//    moments          of a solid of its form
//    farthest         support point along n
//    exit_distance    distance from `point` along the unit vector `direction` to the surface
//    core             the equal capsule, if it is a ball or a capsule
//    prism            the equal prism, if it is one
//    closest          closest features to a capsule of the hand; beyond a distance of `margin` any feature
//                     may be returned
//    span             interval of the capsule's axis over the flat or straight feature at `features`
// A mesh leaves the last two to its MeshCollider, which is built once.

struct Sphere {
  double radius;  ///< [m]

  double bounding_radius() const { return radius; }
  SolidMoments moments() const;
  Vector3 farthest(const Vector3& n) const;
  std::optional<double> exit_distance(const Vector3& point, const Vector3& direction) const;
  [[deprecated("use exit_distance")]] std::optional<double> way_out(const Vector3& point,
                                                                    const Vector3& direction) const {
    return exit_distance(point, direction);
  }
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
  std::optional<double> exit_distance(const Vector3& point, const Vector3& direction) const;
  [[deprecated("use exit_distance")]] std::optional<double> way_out(const Vector3& point,
                                                                    const Vector3& direction) const {
    return exit_distance(point, direction);
  }
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
  std::optional<double> exit_distance(const Vector3& point, const Vector3& direction) const;
  [[deprecated("use exit_distance")]] std::optional<double> way_out(const Vector3& point,
                                                                    const Vector3& direction) const {
    return exit_distance(point, direction);
  }
  std::optional<Capsule> core() const;
  std::optional<PrismForm> prism() const { return PrismForm{{radius, radius, half_length}, true}; }
  ClosestFeatures closest(const Capsule& capsule, double margin) const;
  AxisSpan span(const Capsule& capsule, const ClosestFeatures& features) const;
};

/// A capsule: axis along z, centred at the origin, a hemisphere on each end.
struct Pill {
  double radius;       ///< [m]
  double half_length;  ///< of the straight part [m]

  double bounding_radius() const { return half_length + radius; }
  SolidMoments moments() const;
  Vector3 farthest(const Vector3& n) const;
  std::optional<double> exit_distance(const Vector3& point, const Vector3& direction) const;
  [[deprecated("use exit_distance")]] std::optional<double> way_out(const Vector3& point,
                                                                    const Vector3& direction) const {
    return exit_distance(point, direction);
  }
  std::optional<Capsule> core() const;
  std::optional<PrismForm> prism() const { return std::nullopt; }
  ClosestFeatures closest(const Capsule& capsule, double margin) const;
  AxisSpan span(const Capsule& capsule, const ClosestFeatures& features) const;
};

struct Mesh {
  std::shared_ptr<const TriangleMesh> triangles;  ///< scaled, in the shape's frame
  std::string uri;                                ///< for display: as in the URDF; a path becomes file://
  Vector3 scale = Vector3::Ones();

  double bounding_radius() const;
  SolidMoments moments() const;
  Vector3 farthest(const Vector3& n) const;
  std::optional<double> exit_distance(const Vector3& point, const Vector3& direction) const;
  [[deprecated("use exit_distance")]] std::optional<double> way_out(const Vector3& point,
                                                                    const Vector3& direction) const {
    return exit_distance(point, direction);
  }
  std::optional<Capsule> core() const;
  std::optional<PrismForm> prism() const { return std::nullopt; }
};

using Shape = std::variant<Sphere, Box, Cylinder, Pill, Mesh>;

/// A collision shape and its pose in the body frame.
struct PlacedShape {
  Shape shape;
  Pose pose;
};

/// A visual shape and its pose in the body frame.
struct Visual {
  Shape shape;
  Pose pose;
  std::array<float, 4> rgba{{0.7f, 0.7f, 0.7f, 1.0f}};
  bool has_color = false;  ///< a colour is given; a mesh without one keeps its file's materials
};

/// Radius of the smallest sphere around the shape frame's origin that contains the shape [m].
double bounding_radius(const Shape& shape);

}  // namespace mrhi
