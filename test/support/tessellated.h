#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <vector>

#include "mr_hand_interaction/scene/shape.h"

namespace mrhi::testing {

/// Puts a mesh together from triangles by their corners; those at one place are one.
class MeshMaker {
 public:
  void triangle(const Vector3& a, const Vector3& b, const Vector3& c) {
    mesh_.triangles.push_back({{vertex(a), vertex(b), vertex(c)}});
  }
  void square(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d) {
    triangle(a, b, c), triangle(a, c, d);
  }
  TriangleMesh take() { return std::move(mesh_); }

 private:
  /// To 1e-9 m: the same place may be reached by different sums.
  int vertex(const Vector3& place) {
    std::array<long, 3> key{};
    for (int i = 0; i < 3; ++i) key[std::size_t(i)] = std::lround(place[i] * 1e9);
    const auto inserted = known_.emplace(key, int(mesh_.vertices.size()));
    if (inserted.second) mesh_.vertices.push_back(place);
    return inserted.first->second;
  }
  TriangleMesh mesh_;
  std::map<std::array<long, 3>, int> known_;
};

/// A box of n * n squares a side: 12 n^2 triangles.
inline TriangleMesh tessellated_box(const Vector3& half, int n) {
  MeshMaker maker;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const int first = (axis + 1) % 3, second = (axis + 2) % 3;
      const auto at = [&](int i, int j) {
        Vector3 place;
        place[axis] = side * half[axis];
        place[first] = side * (2.0 * i / n - 1.0) * half[first];
        place[second] = (2.0 * j / n - 1.0) * half[second];
        return place;
      };
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) maker.square(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
  return maker.take();
}

/// A can along z of `around` sides in `levels` rings, its caps cut in `rings`.
inline TriangleMesh tessellated_can(double radius, double half_length, int around, int levels, int rings) {
  MeshMaker maker;
  const auto at = [&](int i, double r, double z) {
    const double angle = 2.0 * M_PI * (i % around) / around;
    return Vector3(r * std::cos(angle), r * std::sin(angle), z);
  };
  for (int i = 0; i < around; ++i) {
    for (int k = 0; k < levels; ++k) {
      const double low = half_length * (2.0 * k / levels - 1.0),
                   high = half_length * (2.0 * (k + 1) / levels - 1.0);
      maker.square(at(i, radius, low), at(i + 1, radius, low), at(i + 1, radius, high), at(i, radius, high));
    }
    for (const double side : {-1.0, 1.0}) {
      const double z = side * half_length;
      for (int k = 0; k < rings; ++k) {
        const double inner = radius * k / rings, outer = radius * (k + 1) / rings;
        const int a = side > 0 ? i : i + 1, b = side > 0 ? i + 1 : i;
        if (k == 0) {
          maker.triangle(at(a, 0.0, z), at(a, outer, z), at(b, outer, z));
        } else {
          maker.square(at(a, inner, z), at(a, outer, z), at(b, outer, z), at(b, inner, z));
        }
      }
    }
  }
  return maker.take();
}

/// A surface r(u, v) over 0..1 x 0..1 in n * m squares, with u to the right of v seen from outside.
template <typename Place>
TriangleMesh patchwork(int n, int m, const Place& place) {
  MeshMaker maker;
  const auto triangle = [&](const Vector3& a, const Vector3& b, const Vector3& c) {
    if ((a - b).norm() > 1e-8 && (b - c).norm() > 1e-8 && (c - a).norm() > 1e-8) maker.triangle(a, b, c);
  };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < m; ++j) {
      const Vector3 a = place(double(i) / n, double(j) / m), b = place((i + 1.0) / n, double(j) / m);
      const Vector3 c = place((i + 1.0) / n, (j + 1.0) / m), d = place(double(i) / n, (j + 1.0) / m);
      triangle(a, b, c), triangle(a, c, d);
    }
  }
  return maker.take();
}

/// Of 4 k (k - 1) triangles.
inline TriangleMesh tessellated_ball(double radius, int k) {
  return patchwork(2 * k, k, [&](double u, double v) -> Vector3 {
    const double a = 2.0 * M_PI * u, b = M_PI * (v - 0.5);
    return radius * Vector3(std::cos(b) * std::cos(a), std::cos(b) * std::sin(a), std::sin(b));
  });
}

/// A square bar along z whose edges are rounded with k facets each.
inline TriangleMesh tessellated_rounded_bar(double half, double rounding, int k, double half_length) {
  const int around = 4 * (k + 1);
  return patchwork(around, 3, [&](double u, double v) -> Vector3 {
    const int i = int(std::lround(u * around)) % around, row = int(std::lround(3.0 * v));
    const int quarter = i / (k + 1);
    const double a = 0.5 * M_PI * (quarter + double(i % (k + 1)) / k),
                 z = row < 2 ? -half_length : half_length;
    if (row == 0 || row == 3) return {0.0, 0.0, z};
    const double x = quarter == 0 || quarter == 3 ? 1.0 : -1.0, y = quarter < 2 ? 1.0 : -1.0;
    return {x * (half - rounding) + rounding * std::cos(a), y * (half - rounding) + rounding * std::sin(a),
            z};
  });
}

/// Of 4 k^2 triangles, about z.
inline TriangleMesh tessellated_ring(double radius, double tube, int k) {
  return patchwork(2 * k, k, [&](double u, double v) -> Vector3 {
    const double a = 2.0 * M_PI * u, b = 2.0 * M_PI * v, r = radius + tube * std::cos(b);
    return {r * std::cos(a), r * std::sin(a), tube * std::sin(b)};
  });
}

/// The same surface with vertices and triangles in another order.
inline TriangleMesh shuffled(const TriangleMesh& mesh, unsigned seed) {
  std::mt19937 random(seed);
  const auto shuffle = [&](auto& items) {
    for (std::size_t i = items.size(); i > 1; --i) std::swap(items[i - 1], items[random() % i]);
  };
  std::vector<std::size_t> order(mesh.vertices.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  shuffle(order);
  TriangleMesh result;
  std::vector<int> renamed(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    renamed[order[i]] = int(i);
    result.vertices.push_back(mesh.vertices[order[i]]);
  }
  result.triangles = mesh.triangles;
  shuffle(result.triangles);
  for (std::array<int, 3>& triangle : result.triangles) {
    for (int& v : triangle) v = renamed[std::size_t(v)];
    std::rotate(triangle.begin(), triangle.begin() + random() % 3, triangle.end());
  }
  return result;
}

/// As a file has it: vertices are floats.
inline TriangleMesh in_floats(TriangleMesh mesh) {
  for (Vector3& v : mesh.vertices) v = v.cast<float>().cast<double>();
  return mesh;
}

inline TriangleMesh turned(TriangleMesh mesh, const Quaternion& turn) {
  for (Vector3& v : mesh.vertices) v = turn * v;
  return mesh;
}

}  // namespace mrhi::testing
