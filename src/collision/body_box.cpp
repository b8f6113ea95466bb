#include "body_box.h"

namespace mrhi {

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
