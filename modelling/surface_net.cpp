#include "surface_net.h"

#include <cmath>

#include "skin_shape.h"

namespace mrhi {
namespace {

constexpr int kEveningPasses = 12;

/// The field at the corners of cubic cells.
class Grid {
 public:
  Grid(const DistanceField& distance, const Vector3& lowest, const Vector3& highest, double cell)
      : lowest_(lowest), cell_(cell) {
    for (int axis = 0; axis < 3; ++axis)
      size_[axis] = static_cast<int>(std::ceil((highest - lowest)[axis] / cell)) + 1;
    values_.reserve(static_cast<std::size_t>(size_.prod()));
    for (int z = 0; z < size_.z(); ++z)
      for (int y = 0; y < size_.y(); ++y)
        for (int x = 0; x < size_.x(); ++x) values_.push_back(distance(place(Eigen::Vector3i(x, y, z))));
  }

  const Eigen::Vector3i& size() const { return size_; }
  std::size_t index(const Eigen::Vector3i& n) const {
    const int at = (n.z() * size_.y() + n.y()) * size_.x() + n.x();
    return static_cast<std::size_t>(at);
  }
  double value(const Eigen::Vector3i& n) const { return values_[index(n)]; }
  Vector3 place(const Eigen::Vector3i& n) const { return lowest_ + cell_ * n.cast<double>(); }

  /// Mean of the points where the cell's edges cross the surface; false if none does.
  bool crossing(const Eigen::Vector3i& cell, Vector3& mean) const {
    int crossings = 0;
    mean.setZero();
    for (int axis = 0; axis < 3; ++axis) {
      for (int edge = 0; edge < 4; ++edge) {
        Eigen::Vector3i a = cell;
        a[(axis + 1) % 3] += edge & 1;
        a[(axis + 2) % 3] += edge >> 1;
        const Eigen::Vector3i b = a + Eigen::Vector3i::Unit(axis);
        const double at_a = value(a), at_b = value(b);
        if ((at_a < 0.0) == (at_b < 0.0)) continue;
        mean += place(a) + at_a / (at_a - at_b) * (place(b) - place(a));
        ++crossings;
      }
    }
    if (crossings > 0) mean /= crossings;
    return crossings > 0;
  }

 private:
  Vector3 lowest_;
  double cell_;
  Eigen::Vector3i size_;
  std::vector<double> values_;
};

template <typename Visit>
void for_each_cell(const Grid& grid, Visit visit) {
  for (int z = 0; z + 1 < grid.size().z(); ++z)
    for (int y = 0; y + 1 < grid.size().y(); ++y)
      for (int x = 0; x + 1 < grid.size().x(); ++x) visit(Eigen::Vector3i(x, y, z));
}

void add_quad(std::array<int, 4> q, bool reversed, TriangleMesh& mesh) {
  if (reversed) std::swap(q[1], q[3]);
  const auto at = [&](int i) {
    return mesh.vertices[static_cast<std::size_t>(q[static_cast<std::size_t>(i)])];
  };
  if ((at(0) - at(2)).squaredNorm() <= (at(1) - at(3)).squaredNorm()) {
    mesh.triangles.push_back({q[0], q[1], q[2]});
    mesh.triangles.push_back({q[0], q[2], q[3]});
  } else {
    mesh.triangles.push_back({q[1], q[2], q[3]});
    mesh.triangles.push_back({q[1], q[3], q[0]});
  }
}

/// A vertex in each cell that the surface passes, a quad across each edge that passes the surface.
TriangleMesh net(const Grid& grid) {
  TriangleMesh mesh;
  std::vector<int> vertex_of(static_cast<std::size_t>(grid.size().prod()), -1);
  for_each_cell(grid, [&](const Eigen::Vector3i& cell) {
    Vector3 vertex;
    if (!grid.crossing(cell, vertex)) return;
    vertex_of[grid.index(cell)] = static_cast<int>(mesh.vertices.size());
    mesh.vertices.push_back(vertex);
  });
  for_each_cell(grid, [&](const Eigen::Vector3i& cell) {
    for (int axis = 0; axis < 3; ++axis) {
      const bool inside = grid.value(cell) < 0.0;
      if (inside == (grid.value(cell + Eigen::Vector3i::Unit(axis)) < 0.0)) continue;
      const Eigen::Vector3i u = Eigen::Vector3i::Unit((axis + 1) % 3),
                            v = Eigen::Vector3i::Unit((axis + 2) % 3);
      const auto vertex = [&](const Eigen::Vector3i& c) { return vertex_of[grid.index(c)]; };
      add_quad({vertex(cell - u - v), vertex(cell - v), vertex(cell), vertex(cell - u)}, !inside, mesh);
    }
  });
  return mesh;
}

/// Vertices go half of the way to the middle of their neighbours, and back onto the surface.
void even_out(const DistanceField& distance, TriangleMesh& mesh) {
  std::vector<Vector3> sums(mesh.vertices.size());
  std::vector<int> counts(mesh.vertices.size());
  for (int pass = 0; pass < kEveningPasses; ++pass) {
    std::fill(sums.begin(), sums.end(), Vector3::Zero());
    std::fill(counts.begin(), counts.end(), 0);
    for (const auto& triangle : mesh.triangles) {
      for (std::size_t i = 0; i < 3; ++i) {
        const auto a = static_cast<std::size_t>(triangle[i]),
                   b = static_cast<std::size_t>(triangle[(i + 1) % 3]);
        sums[a] += mesh.vertices[b];
        ++counts[a];
      }
    }
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
      Vector3& p = mesh.vertices[i];
      p = 0.5 * (p + sums[i] / counts[i]);
      const Vector3 g = gradient(distance, p);
      p -= distance(p) / g.squaredNorm() * g;
    }
  }
}

}  // namespace

TriangleMesh surface_net(const DistanceField& distance, const Vector3& lowest, const Vector3& highest,
                         double cell) {
  TriangleMesh mesh = net(Grid(distance, lowest, highest, cell));
  even_out(distance, mesh);
  return mesh;
}

}  // namespace mrhi
