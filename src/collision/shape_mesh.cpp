#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>

#include "../scene/solid_mesh.h"
#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/scene/shape.h"

namespace mrhi {
namespace {

Vector3 farthest_vertex(const TriangleMesh& mesh, const Vector3& n) {
  if (mesh.vertices.empty()) return Vector3::Zero();
  return *std::max_element(mesh.vertices.begin(), mesh.vertices.end(),
                           [&](const Vector3& a, const Vector3& b) { return n.dot(a) < n.dot(b); });
}

struct Extent {
  explicit Extent(const TriangleMesh& mesh) {
    double squared = 0.0;
    for (const std::array<int, 3>& triangle : mesh.triangles)
      for (const int v : triangle) squared = std::max(squared, mesh.vertices[v].squaredNorm());
    radius = std::sqrt(squared);
    for (int i = 0; i < 3; ++i) {
      along[i] = farthest_vertex(mesh, Vector3::Unit(i));
      against[i] = farthest_vertex(mesh, -Vector3::Unit(i));
    }
  }
  double radius;
  std::array<Vector3, 3> along, against;  // farthest vertices along and against x, y and z
};

/// Computed once for a mesh: every change of a running scene asks for it, and frames wait meanwhile.
Extent extent_of(const std::shared_ptr<const TriangleMesh>& mesh) {
  static std::mutex mutex;
  static std::map<std::weak_ptr<const TriangleMesh>, Extent, std::owner_less<>> known;
  {
    const std::lock_guard<std::mutex> lock(mutex);
    const auto found = known.find(mesh);
    if (found != known.end()) return found->second;
    for (auto one = known.begin(); one != known.end();)
      one = one->first.expired() ? known.erase(one) : std::next(one);
  }
  const Extent extent(*mesh);
  const std::lock_guard<std::mutex> lock(mutex);
  return known.emplace(mesh, extent).first->second;
}

}  // namespace

std::optional<Capsule> Mesh::core() const {
  return std::nullopt;
}

/// Vertices that no triangle has do not count.
double Mesh::bounding_radius() const {
  return extent_of(triangles).radius;
}

Vector3 Mesh::farthest(const Vector3& n) const {
  for (int i = 0; i < 3; ++i) {
    if (n == Vector3::Unit(i)) return extent_of(triangles).along[i];
    if (n == -Vector3::Unit(i)) return extent_of(triangles).against[i];
  }
  return farthest_vertex(*triangles, n);
}

std::optional<double> Mesh::exit_distance(const Vector3&, const Vector3&) const {
  return std::nullopt;
}

SolidMoments Mesh::moments() const {
  SolidMoments moments = signed_moments(*triangles);
  if (triangles->parts.empty()) return moments;
  const SolidMoments shared = shared_moments(*triangles, moments.volume);
  moments.volume -= shared.volume, moments.first -= shared.first, moments.second -= shared.second;
  return moments;
}

}  // namespace mrhi
