#include "body_box.h"

namespace mrhi {

/// By the support function, exactly: in a shape's frame the body's axis e_i is R^T e_i, and the shape reaches
/// position_i + h(R^T e_i) along it. h is asked for both signs, as a mesh is not symmetric.
BodyBox box_around(const Body& body) {
  if (body.shapes.empty()) return {};
  Vector3 min = Vector3::Constant(1e300), max = -min;
  for (const PlacedShape& placed : body.shapes) {
    const Matrix3 to_body = placed.pose.orientation.toRotationMatrix();
    const auto reach = [&](const Vector3& n) {
      const Vector3 local = to_body.transpose() * n;
      return local.dot(std::visit([&](const auto& shape) { return shape.farthest(local); }, placed.shape));
    };
    for (int i = 0; i < 3; ++i) {
      max[i] = std::max(max[i], placed.pose.position[i] + reach(Vector3::Unit(i)));
      min[i] = std::min(min[i], placed.pose.position[i] - reach(-Vector3::Unit(i)));
    }
  }
  return {0.5 * (min + max), 0.5 * (max - min)};
}

}  // namespace mrhi
