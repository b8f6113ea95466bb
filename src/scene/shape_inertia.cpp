#include "shape_inertia.h"

namespace mrhi {
namespace {

SolidMoments placed(const SolidMoments& in_shape, const Pose& pose) {
  const Matrix3 turn = pose.orientation.toRotationMatrix();
  const Vector3 first = turn * in_shape.first;
  SolidMoments moments;
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
    const SolidMoments moments =
        placed(std::visit([](const auto& asked) { return asked.moments(); }, shape.shape), shape.pose);
    volume += moments.volume, second += moments.second;
  }
  if (!(volume > 0.0)) return Matrix3::Zero();
  return mass / volume * (second.trace() * Matrix3::Identity() - second);
}

}  // namespace mrhi
