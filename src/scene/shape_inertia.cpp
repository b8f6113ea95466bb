#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "solid_mesh.h"

namespace mrhi {

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

namespace {

/// A run of qhull: its memory, and a buffer for what it would print.
class Qhull {
 public:
  Qhull() : complaints_(open_memstream(&text_, &length_)) { qh_zero(&qh_, complaints_); }
  ~Qhull() {
    int kept = 0, total = 0;
    qh_freeqhull(&qh_, !qh_ALL);
    qh_memfreeshort(&qh_, &kept, &total);
    std::fclose(complaints_);
    std::free(text_);
  }
  Qhull(const Qhull&) = delete;
  Qhull& operator=(const Qhull&) = delete;

  bool run(std::vector<Vector3>& points) {
    static_assert(sizeof(Vector3) == 3 * sizeof(coordT), "points are read in place");
    char command[] = "qhull";
    return qh_new_qhull(&qh_, 3, static_cast<int>(points.size()), points[0].data(), False, command, nullptr,
                        complaints_) == 0;
  }
  /// Calls `see(points)` for each facet with the indices of its points, in order around it. Seen from
  /// outside, all facets have the same orientation.
  template <typename See>
  void each_facet(const See& see) {
    for (facetT* facet = qh_.facet_list; facet != nullptr && facet->next != nullptr; facet = facet->next) {
      setT* around = qh_facet3vertex(&qh_, facet);
      const int count = qh_setsize(&qh_, around);
      std::vector<int> points;
      points.reserve(static_cast<std::size_t>(count));
      for (int i = 0; i < count; ++i)
        points.push_back(qh_pointid(&qh_, static_cast<vertexT*>(SETelem_(around, i))->point));
      qh_settempfree(&qh_, &around);
      see(points);
    }
  }

 private:
  char* text_ = nullptr;
  std::size_t length_ = 0;
  std::FILE* complaints_;
  qhT qh_{};
};

void add(const SolidMoments& part, double sign, SolidMoments& sum) {
  sum.volume += sign * part.volume;
  sum.first += sign * part.first;
  sum.second += sign * part.second;
}

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

bool may_overlap(const std::vector<PlacedShape>& shapes) {
  std::vector<Eigen::AlignedBox3d> boxes;
  boxes.reserve(shapes.size());
  for (const PlacedShape& shape : shapes) boxes.push_back(box_around(shape));
  for (std::size_t a = 0; a < boxes.size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
      if ((boxes[a].intersection(boxes[b]).sizes().array() > 0.0).all()) return true;
  return false;
}

SolidMoments sum_of(const std::vector<PlacedShape>& shapes) {
  SolidMoments all;
  for (const PlacedShape& shape : shapes) {
    const TriangleMesh* const mesh = mesh_of(shape);
    const SolidMoments own = mesh != nullptr
                                 ? signed_moments(*mesh)
                                 : std::visit([](const auto& any) { return any.moments(); }, shape.shape);
    add(placed(own, shape.pose), 1.0, all);
  }
  return all;
}

/// Crossings of a mesh's surface by lines along x, on a grid in y and z.
class Columns {
 public:
  explicit Columns(const TriangleMesh& mesh) : lines_(kLines * kLines) {
    const Eigen::AlignedBox3d box = box_around(mesh);
    low_ = {box.min().y(), box.min().z()};
    cell_ = Eigen::Vector2d(box.sizes().y(), box.sizes().z()) / kLines;
    if (!(cell_.minCoeff() > 0.0)) return;
    for (const auto& t : mesh.triangles) cross(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
  }

  /// Moments of the volume that parts share. Between two crossings a line is inside n parts; n - 1 of them
  /// are counted too often.
  SolidMoments shared() {
    SolidMoments sum;
    for (std::size_t line = 0; line < lines_.size(); ++line) {
      auto& crossings = lines_[line];
      std::sort(crossings.begin(), crossings.end());
      int within = 0;
      for (const auto& crossing : crossings) within += crossing.second;
      if (within != 0) continue;  // the line met an edge
      const Eigen::Vector2d at = place(int(line % kLines), int(line / kLines));
      for (std::size_t i = 0; i + 1 < crossings.size(); ++i) {
        within += crossings[i].second;
        if (within > 1) add_stretch(crossings[i].first, crossings[i + 1].first, at, within - 1, sum);
      }
    }
    return sum;
  }

 private:
  static constexpr int kLines = 100;  // along each side of the grid

  /// A point beside the middle of a cell, at fractions that no file has, so that lines do not meet edges.
  Eigen::Vector2d place(int i, int j) const {
    return low_ + cell_.cwiseProduct(Eigen::Vector2d(i + 0.5031417, j + 0.4972853));
  }
  void add_stretch(double x0, double x1, const Eigen::Vector2d& at, int times, SolidMoments& sum) const {
    const double area = times * cell_.prod(), length = x1 - x0;
    const double x = 0.5 * (x1 * x1 - x0 * x0), xx = (x1 * x1 * x1 - x0 * x0 * x0) / 3.0;
    const double y = at.x(), z = at.y();
    Matrix3 second;
    second << xx, x * y, x * z, x * y, length * y * y, length * y * z, x * z, length * y * z, length * z * z;
    sum.volume += area * length;
    sum.first += area * Vector3(x, length * y, length * z);
    sum.second += area * second;
  }
  void cross(const Vector3& a, const Vector3& b, const Vector3& c) {
    const Eigen::Vector2d p = a.tail<2>(), q = b.tail<2>(), r = c.tail<2>();
    const auto side = [](const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Eigen::Vector2d& at) {
      return (to - from).x() * (at - from).y() - (to - from).y() * (at - from).x();
    };
    const double twice = side(p, q, r);
    if (twice == 0.0) return;
    const Eigen::Vector2d low = (p.cwiseMin(q).cwiseMin(r) - low_).cwiseQuotient(cell_),
                          high = (p.cwiseMax(q).cwiseMax(r) - low_).cwiseQuotient(cell_);
    for (int j = std::max(0, int(low.y()) - 1); j <= std::min(kLines - 1, int(high.y())); ++j)
      for (int i = std::max(0, int(low.x()) - 1); i <= std::min(kLines - 1, int(high.x())); ++i) {
        const Eigen::Vector2d at = place(i, j);
        const double u = side(q, r, at) / twice, v = side(r, p, at) / twice, w = 1.0 - u - v;
        if (u < 0.0 || v < 0.0 || w < 0.0) continue;
        // The line enters the solid if the triangle's normal points towards -x.
        lines_[j * kLines + i].emplace_back(u * a.x() + v * b.x() + w * c.x(), twice < 0.0 ? 1 : -1);
      }
  }

  std::vector<std::vector<std::pair<double, int>>> lines_;
  Eigen::Vector2d low_, cell_;
};

}  // namespace

void append(const TriangleMesh& mesh, const Pose& pose, TriangleMesh& all) {
  const int first = static_cast<int>(all.vertices.size());
  for (const Vector3& vertex : mesh.vertices) all.vertices.push_back(pose * vertex);
  for (const auto& t : mesh.triangles) all.triangles.push_back({{t[0] + first, t[1] + first, t[2] + first}});
}

Eigen::AlignedBox3d box_around(const TriangleMesh& mesh, const std::vector<std::array<int, 3>>& triangles) {
  Eigen::AlignedBox3d box;
  for (const auto& triangle : triangles)
    for (const int v : triangle) box.extend(mesh.vertices[v]);
  return box;
}

Eigen::AlignedBox3d box_around(const PlacedShape& shape) {
  Eigen::AlignedBox3d box;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      const Vector3 n = shape.pose.orientation.conjugate() * Vector3(side * Vector3::Unit(axis));
      box.extend(shape.pose * std::visit([&](const auto& any) { return any.farthest(n); }, shape.shape));
    }
  return box;
}

TriangleMesh convex_hull(const TriangleMesh& mesh) {
  std::vector<Vector3> points = mesh.vertices;
  Qhull hull;
  if (points.size() < 4 || !hull.run(points))
    throw NoVolume("has no volume, nor has its convex hull; allowed: corners that are not in one plane");
  TriangleMesh result;
  std::vector<int> name(points.size(), -1);
  hull.each_facet([&](std::vector<int>& around) {
    for (int& point : around) {
      int& known = name[point];
      if (known < 0) {
        known = static_cast<int>(result.vertices.size());
        result.vertices.push_back(mesh.vertices[point]);
      }
      point = known;
    }
    for (std::size_t i = 2; i < around.size(); ++i)
      result.triangles.push_back({{around[0], around[i - 1], around[i]}});
  });
  return result;
}

/// Approximates a convex shape by the hull of its support points in many directions (a Fibonacci lattice).
/// Returns a mesh unchanged.
TriangleMesh surface_of(const PlacedShape& shape) {
  TriangleMesh mesh;
  if (const TriangleMesh* const triangles = mesh_of(shape)) {
    mesh = *triangles;
  } else {
    constexpr int kDirections = 300;
    const auto add_farthest = [&](const Vector3& n) {
      mesh.vertices.push_back(std::visit([&](const auto& any) { return any.farthest(n); }, shape.shape));
    };
    for (int corner = 0; corner < 8; ++corner)
      add_farthest(Vector3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1).normalized());
    for (int i = 0; i < kDirections && !std::holds_alternative<Box>(shape.shape); ++i) {
      const double z = 1.0 - (2.0 * i + 1.0) / kDirections, across = std::sqrt(1.0 - z * z),
                   turn = 2.39996 * i;
      add_farthest({across * std::cos(turn), across * std::sin(turn), z});
    }
    mesh = convex_hull(mesh);
    if (signed_volume(mesh) < 0.0)
      for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  }
  for (Vector3& vertex : mesh.vertices) vertex = shape.pose * vertex;
  return mesh;
}

SolidMoments shared_moments(const TriangleMesh& mesh, double volume) {
  constexpr double kMinSharedFraction = 1e-3;
  const SolidMoments shared = Columns(mesh).shared();
  return shared.volume > kMinSharedFraction * volume ? shared : SolidMoments{};
}

/// Sums the signed tetrahedra from the origin to the triangles (Tonon 2004).
///
/// For a tetrahedron with the corners 0, a, b, c:
///     V = a.(b x c) / 6,   integral of x = V (a + b + c) / 4,
///     integral of x x^T = V / 20 (a a^T + b b^T + c c^T + (a + b + c)(a + b + c)^T).
/// V is positive for a triangle that faces away from the origin, else negative, so volume outside the solid
/// cancels. Valid only for a closed mesh.
SolidMoments signed_moments(const TriangleMesh& mesh) {
  SolidMoments moments;
  for (const std::array<int, 3>& triangle : mesh.triangles) {
    const auto corner = [&](std::size_t i) -> const Vector3& { return mesh.vertices[triangle[i]]; };
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

SolidMoments moments_of(const std::vector<PlacedShape>& shapes) {
  SolidMoments all = sum_of(shapes);
  const bool has_parts = std::any_of(shapes.begin(), shapes.end(), [](const PlacedShape& shape) {
    return mesh_of(shape) != nullptr && !mesh_of(shape)->parts.empty();
  });
  if (!has_parts && !may_overlap(shapes)) return all;
  TriangleMesh surfaces;
  for (const PlacedShape& shape : shapes) append(surface_of(shape), Pose{}, surfaces);
  add(shared_moments(surfaces, all.volume), -1.0, all);
  return all;
}

Matrix3 inertia_of(const std::vector<PlacedShape>& shapes, double mass) {
  const bool has_mesh = std::any_of(shapes.begin(), shapes.end(), mesh_of);
  const SolidMoments moments = has_mesh ? moments_of(shapes) : sum_of(shapes);
  if (!(moments.volume > 0.0)) return Matrix3::Zero();
  return mass / moments.volume * (moments.second.trace() * Matrix3::Identity() - moments.second);
}

}  // namespace mrhi
