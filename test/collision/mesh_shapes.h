#pragma once

#include <algorithm>
#include <array>
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

/// A cube about the origin without its eighth where all coordinates are positive: a corner that points
/// inwards.
inline TriangleMesh notched_cube(double half) {
  TriangleMesh mesh;
  for (int i = 0; i < 27; ++i) mesh.vertices.push_back(half * Vector3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1));
  const auto solid = [](const std::array<int, 3>& cell) {
    const bool within = std::all_of(cell.begin(), cell.end(), [](int c) { return c == 0 || c == 1; });
    return within && cell != std::array<int, 3>{{1, 1, 1}};
  };
  for (int i = 0; i < 8; ++i) {
    const std::array<int, 3> cell{{i & 1, i >> 1 & 1, i >> 2 & 1}};
    if (!solid(cell)) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const int way : {0, 1}) {
        std::array<int, 3> beyond = cell;
        beyond[axis] += 2 * way - 1;
        if (solid(beyond)) continue;
        const std::size_t along = (axis + 1) % 3, across = (axis + 2) % 3;
        const auto corner = [&](int a, int b) {
          std::array<int, 3> at = cell;
          at[axis] += way, at[along] += a, at[across] += b;
          return at[0] + 3 * at[1] + 9 * at[2];
        };
        const int a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
        mesh.triangles.push_back(way == 1 ? std::array<int, 3>{{a, b, c}} : std::array<int, 3>{{a, c, b}});
        mesh.triangles.push_back(way == 1 ? std::array<int, 3>{{a, c, d}} : std::array<int, 3>{{a, d, c}});
      }
    }
  }
  return mesh;
}

/// Two arms of 60 x 20 mm that meet at a right angle about the origin, 40 mm high: (-20..40) x (-20..0) and
/// (-20..0) x (-20..40). The inner edge is at the origin.
inline TriangleMesh angle_mesh() {
  constexpr double a = 0.02, b = 0.04;
  return prism({{-a, -a}, {b, -a}, {b, 0}, {0, 0}, {0, b}, {-a, b}},
               {{{0, 1, 2}}, {{0, 2, 3}}, {{0, 3, 4}}, {{0, 4, 5}}}, 0.02);
}

}  // namespace mrhi
