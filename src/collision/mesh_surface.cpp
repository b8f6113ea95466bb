#include "mesh_surface.h"

#include <map>

namespace mrhi {
namespace {

/// Edges that bend by less are part of a flat face [rad].
constexpr double kFlat = 1e-7;

double corner_angle(const Triangle& triangle, std::size_t i) {
  const Vector3 a = triangle.corners[(i + 1) % 3] - triangle.corners[i];
  const Vector3 b = triangle.corners[(i + 2) % 3] - triangle.corners[i];
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace

MeshSurface::MeshSurface(const TriangleMesh& mesh) {
  min_ = Vector3::Constant(1e300), max_ = -min_;
  for (const std::array<int, 3>& indices : mesh.triangles) {
    Triangle triangle;
    for (std::size_t i = 0; i < 3; ++i) {
      triangle.corners[i] = mesh.vertices[static_cast<std::size_t>(indices[i])];
    }
    const Vector3 area =
        (triangle.corners[1] - triangle.corners[0]).cross(Vector3(triangle.corners[2] - triangle.corners[0]));
    if (area.norm() == 0.0) continue;
    triangle.normal = area.normalized();
    triangles_.push_back(triangle);
    corners_.push_back(indices);
    for (const Vector3& corner : triangle.corners) min_ = min_.cwiseMin(corner), max_ = max_.cwiseMax(corner);
  }
  find_normals(mesh);
  find_edges();
}

void MeshSurface::find_normals(const TriangleMesh& mesh) {
  vertex_normals_.assign(mesh.vertices.size(), Vector3::Zero());
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      vertex_normals_[static_cast<std::size_t>(corners_[t][i])] +=
          corner_angle(triangles_[t], i) * triangles_[t].normal;
    }
  }
}

void MeshSurface::find_edges() {
  struct Side {
    std::size_t triangle, edge;
  };
  std::map<std::pair<int, int>, Side> sides;  // by the edge's direction
  edge_normals_.resize(triangles_.size());
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      edge_normals_[t][i] = triangles_[t].normal;
      closed_ &= sides.insert({{corners_[t][i], corners_[t][(i + 1) % 3]}, {t, i}}).second;
    }
  }
  for (const auto& side : sides) {
    const auto twin = sides.find({side.first.second, side.first.first});
    if (twin == sides.end()) {
      closed_ = false;
    } else if (side.first.first < side.first.second) {
      const Side &a = side.second, &b = twin->second;
      const Vector3 sum = triangles_[a.triangle].normal + triangles_[b.triangle].normal;
      edge_normals_[a.triangle][a.edge] = edge_normals_[b.triangle][b.edge] = sum;
      add_edge(triangles_[a.triangle], a.edge, triangles_[b.triangle]);
    }
  }
  convex_ &= closed_;
}

void MeshSurface::add_edge(const Triangle& triangle, std::size_t edge, const Triangle& other) {
  const Vector3& start = triangle.corners[edge];
  const Vector3 along = triangle.corners[(edge + 1) % 3] - start;
  const double bend = triangle.normal.cross(other.normal).dot(along.normalized());
  if (bend > kFlat) convex_edges_.push_back({start, along, triangle.normal, other.normal});
  if (bend < -kFlat) convex_ = false;
}

bool MeshSurface::in_bounds(const Vector3& place) const {
  return (place.array() >= min_.array()).all() && (place.array() <= max_.array()).all();
}

const Vector3& MeshSurface::normal(int triangle, const TriangleNearest& nearest) const {
  const auto t = static_cast<std::size_t>(triangle), i = static_cast<std::size_t>(nearest.index);
  if (nearest.part == TrianglePart::face) return triangles_[t].normal;
  if (nearest.part == TrianglePart::edge) return edge_normals_[t][i];
  return vertex_normals_[static_cast<std::size_t>(corners_[t][i])];
}

}  // namespace mrhi
