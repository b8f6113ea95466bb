#pragma once

#include <vector>

#include "mr_hand_interaction/scene/shape.h"

namespace mrhi {

/// A straight prism along z over an outline in the xy plane (counter-clockwise), cut into triangles that are
/// indices of the outline.
inline TriangleMesh prism(const std::vector<Eigen::Vector2d>& outline,
                          const std::vector<std::array<int, 3>>& cut, double half_height) {
  TriangleMesh mesh;
  const int n = static_cast<int>(outline.size());
  for (const double z : {-half_height, half_height}) {
    for (const Eigen::Vector2d& corner : outline) mesh.vertices.emplace_back(corner.x(), corner.y(), z);
  }
  for (const auto& t : cut) {
    mesh.triangles.push_back({{t[2], t[1], t[0]}});
    mesh.triangles.push_back({{n + t[0], n + t[1], n + t[2]}});
  }
  for (int i = 0; i < n; ++i) {
    const int next = (i + 1) % n;
    mesh.triangles.push_back({{i, next, n + next}});
    mesh.triangles.push_back({{i, n + next, n + i}});
  }
  return mesh;
}

inline TriangleMesh box_mesh(const Vector3& half) {
  const double x = half.x(), y = half.y();
  return prism({{-x, -y}, {x, -y}, {x, y}, {-x, y}}, {{{0, 1, 2}}, {{0, 2, 3}}}, half.z());
}

/// Two arms of 60 x 20 mm that meet at a right angle about the origin, 40 mm high: (-20..40) x (-20..0) and
/// (-20..0) x (-20..40). The inner edge is at the origin.
inline TriangleMesh angle_mesh() {
  constexpr double a = 0.02, b = 0.04;
  return prism({{-a, -a}, {b, -a}, {b, 0}, {0, 0}, {0, b}, {-a, b}},
               {{{0, 1, 2}}, {{0, 2, 3}}, {{0, 3, 4}}, {{0, 4, 5}}}, 0.02);
}

}  // namespace mrhi
