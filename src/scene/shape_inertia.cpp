#include "shape_inertia.h"

namespace mrhi {
namespace {

constexpr double kPi = 3.141592653589793;

/// Of a solid in its frame: volume, the integral of x over it, and that of x x^T.
struct Moments {
  double volume = 0.0;
  Vector3 first = Vector3::Zero();
  Matrix3 second = Matrix3::Zero();
};

struct MomentsOf {
  Moments operator()(const Sphere& sphere) const {
    const double volume = 4.0 / 3.0 * kPi * sphere.radius * sphere.radius * sphere.radius;
    return {volume, Vector3::Zero(), 0.2 * volume * sphere.radius * sphere.radius * Matrix3::Identity()};
  }
  Moments operator()(const Box& box) const {
    const double volume = 8.0 * box.half_extents.prod();
    return {volume, Vector3::Zero(), (volume / 3.0 * box.half_extents.cwiseAbs2()).asDiagonal()};
  }
  Moments operator()(const Cylinder& cylinder) const {
    const double square = cylinder.radius * cylinder.radius;
    const double volume = 2.0 * kPi * square * cylinder.half_length;
    const Vector3 second(0.25 * square, 0.25 * square, cylinder.half_length * cylinder.half_length / 3.0);
    return {volume, Vector3::Zero(), (volume * second).asDiagonal()};
  }
  /// By the tetrahedra from the origin to the triangles, with their signs (Tonon 2004).
  Moments operator()(const Mesh& mesh) const {
    Moments moments;
    for (const std::array<int, 3>& triangle : mesh.triangles->triangles) {
      const auto corner = [&](std::size_t i) -> const Vector3& {
        return mesh.triangles->vertices[static_cast<std::size_t>(triangle[i])];
      };
      const Vector3 &a = corner(0), &b = corner(1), &c = corner(2);
      const double volume = a.dot(b.cross(c)) / 6.0;
      const Vector3 sum = a + b + c;
      moments.volume += volume;
      moments.first += 0.25 * volume * sum;
      moments.second +=
          0.05 * volume * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
    }
    return moments;
  }
};

Moments placed(const Moments& in_shape, const Pose& pose) {
  const Matrix3 turn = pose.orientation.toRotationMatrix();
  const Vector3 first = turn * in_shape.first;
  Moments moments;
  moments.volume = in_shape.volume;
  moments.first = first + in_shape.volume * pose.position;
  moments.second = turn * in_shape.second * turn.transpose() + first * pose.position.transpose() +
                   pose.position * first.transpose() +
                   in_shape.volume * pose.position * pose.position.transpose();
  return moments;
}

}  // namespace

Matrix3 inertia_of(const std::vector<PlacedShape>& shapes, double mass) {
  double volume = 0.0;
  Matrix3 second = Matrix3::Zero();
  for (const PlacedShape& shape : shapes) {
    const Moments moments = placed(std::visit(MomentsOf{}, shape.shape), shape.pose);
    volume += moments.volume, second += moments.second;
  }
  if (!(volume > 0.0)) return Matrix3::Zero();
  return mass / volume * (second.trace() * Matrix3::Identity() - second);
}

}  // namespace mrhi
