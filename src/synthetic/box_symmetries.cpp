#include "box_symmetries.h"

#include <variant>

namespace mrhi {

std::vector<Quaternion> box_symmetries(const Body& body) {
  std::vector<Quaternion> turns{Quaternion::Identity()};
  const auto* box = body.shapes.size() == 1 ? std::get_if<Box>(&body.shapes[0].shape) : nullptr;
  if (box == nullptr) return turns;
  constexpr int kOrders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  for (const auto& order : kOrders) {
    for (int signs = 0; signs < 8; ++signs) {
      Matrix3 axes = Matrix3::Zero();
      for (int i = 0; i < 3; ++i) axes(order[i], i) = (signs >> i & 1) != 0 ? -1.0 : 1.0;
      const Vector3 image = axes.cwiseAbs() * box->half_extents;
      const bool identity = axes.isIdentity();
      if (axes.determinant() > 0.0 && image.isApprox(box->half_extents, 1e-9) && !identity)
        turns.emplace_back(axes);
    }
  }
  return turns;
}

}  // namespace mrhi
