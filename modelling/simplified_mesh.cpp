#include "simplified_mesh.h"

#include <algorithm>
#include <queue>

namespace mrhi {
namespace {

constexpr double kLongest = 0.020;  // of an edge, that colours run over [m]
constexpr double kEven = 5e-4;      // what an edge's length counts against the surface's moving
constexpr double kFacing = 0.5;     // least cosine between a triangle and the surface that it stands for
constexpr double kSlimmest = 0.15;  // of a triangle; 1 is equilateral

using Triangle = std::array<int, 3>;

std::size_t at(int index) {
  return static_cast<std::size_t>(index);
}

/// Sum of squared distances to planes, weighted by the triangles' areas.
struct Quadric {
  Matrix3 a = Matrix3::Zero();
  Vector3 b = Vector3::Zero();
  double c = 0.0;

  void add_plane(const Vector3& area, const Vector3& point) {
    const double weight = area.norm();
    if (weight <= 0.0) return;
    const Vector3 n = area / weight;
    const double d = -n.dot(point);
    a += weight * n * n.transpose();
    b += weight * d * n;
    c += weight * d * d;
  }
  void add(const Quadric& other) { a += other.a, b += other.b, c += other.c; }
  double of(const Vector3& x) const { return x.dot(a * x) + 2.0 * b.dot(x) + c; }
};

struct Collapse {
  double cost;
  int from, to;
  int age_from, age_to;  // of the ends as the cost was found
  friend bool operator<(const Collapse& l, const Collapse& r) { return l.cost > r.cost; }  // the least on top
};

class Simplifier {
 public:
  Simplifier(const TriangleMesh& mesh, const std::vector<Places>& poses, const std::vector<double>& worth)
      : mesh_(mesh),
        poses_(poses),
        left_(mesh.triangles.size()),
        around_(mesh.vertices.size()),
        ages_(mesh.vertices.size(), 0),
        areas_(mesh.vertices.size(), 0.0),
        quadrics_(mesh.vertices.size(), std::vector<Quadric>(poses.size())),
        normals_(poses.size(), Places(mesh.vertices.size(), Vector3::Zero())) {
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      for (const int v : mesh_.triangles[t]) {
        around_[at(v)].push_back(static_cast<int>(t));
        areas_[at(v)] += area(mesh_.triangles[t], poses_[0]).norm();
        for (std::size_t p = 0; p < poses_.size(); ++p) {
          const Vector3 a = area(mesh_.triangles[t], poses_[p]);
          quadrics_[at(v)][p].add_plane(worth[at(v)] * a, poses_[p][at(v)]);
          normals_[p][at(v)] += a;
        }
      }
    }
    for (Places& normals : normals_)
      for (Vector3& normal : normals) normal.normalize();
    for (const Triangle& triangle : mesh_.triangles) {
      for (std::size_t i = 0; i < 3; ++i) propose(triangle[i], triangle[(i + 1) % 3]);
    }
  }

  TriangleMesh reduced_to(std::size_t triangles) {
    while (left_ > triangles && !queue_.empty()) {
      const Collapse next = queue_.top();
      queue_.pop();
      const bool of_now = next.age_from == ages_[at(next.from)] && next.age_to == ages_[at(next.to)];
      if (of_now && is_sound(next)) collapse(next);
    }
    return compact();
  }

 private:
  static Vector3 area(const Triangle& t, const Places& places) {
    return (places[at(t[1])] - places[at(t[0])]).cross(places[at(t[2])] - places[at(t[0])]);
  }
  static double slimness(const Triangle& t, const Places& places) {
    double squares = 0.0;
    for (std::size_t i = 0; i < 3; ++i)
      squares += (places[at(t[i])] - places[at(t[(i + 1) % 3])]).squaredNorm();
    return 2.0 * std::sqrt(3.0) * area(t, places).norm() / squares;
  }

  void propose(int from, int to) {
    double cost = 0.0;
    for (std::size_t p = 0; p < poses_.size(); ++p)
      cost += quadrics_[at(from)][p].of(poses_[p][at(to)]) + quadrics_[at(to)][p].of(poses_[p][at(to)]);
    cost /= static_cast<double>(poses_.size());
    const double squared = (poses_[0][at(from)] - poses_[0][at(to)]).squaredNorm();
    cost += kEven * areas_[at(from)] * squared;
    queue_.push({cost, from, to, ages_[at(from)], ages_[at(to)]});
  }

  std::vector<int> neighbours(int vertex) const {
    std::vector<int> found;
    for (const int t : around_[at(vertex)])
      for (const int v : mesh_.triangles[at(t)])
        if (v != vertex) found.push_back(v);
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  /// The surface stays closed, one piece and unfolded in every pose.
  bool is_sound(const Collapse& collapse) const {
    const auto of_from = neighbours(collapse.from), of_to = neighbours(collapse.to);
    std::vector<int> both;
    std::set_intersection(of_from.begin(), of_from.end(), of_to.begin(), of_to.end(),
                          std::back_inserter(both));
    if (both.size() != 2 || of_from.size() + of_to.size() < 8) return false;
    for (const int v : of_from)
      if ((poses_[0][at(v)] - poses_[0][at(collapse.to)]).norm() > kLongest) return false;
    for (const int t : around_[at(collapse.from)]) {
      const Triangle before = mesh_.triangles[at(t)];
      Triangle after = before;
      if (std::find(before.begin(), before.end(), collapse.to) != before.end()) continue;
      std::replace(after.begin(), after.end(), collapse.from, collapse.to);
      if (slimness(after, poses_[0]) < std::min(kSlimmest, slimness(before, poses_[0]))) return false;
      for (std::size_t p = 0; p < poses_.size(); ++p)
        if (faces_away(after, p)) return false;
    }
    return true;
  }

  /// From the mesh that is simplified.
  bool faces_away(const Triangle& triangle, std::size_t pose) const {
    Vector3 outward = Vector3::Zero();
    for (const int v : triangle) outward += normals_[pose][at(v)];
    const Vector3 a = area(triangle, poses_[pose]);
    return a.dot(outward) < kFacing * a.norm() * outward.norm();
  }

  void collapse(const Collapse& collapse) {
    const auto from = at(collapse.from), to = at(collapse.to);
    for (const int t : around_[from]) {
      Triangle& triangle = mesh_.triangles[at(t)];
      if (std::find(triangle.begin(), triangle.end(), collapse.to) == triangle.end()) {
        std::replace(triangle.begin(), triangle.end(), collapse.from, collapse.to);
        around_[to].push_back(t);
        continue;
      }
      for (const int v : triangle) {
        if (v == collapse.from) continue;
        auto& others = around_[at(v)];
        others.erase(std::remove(others.begin(), others.end(), t), others.end());
      }
      triangle = {-1, -1, -1};
      --left_;
    }
    around_[from].clear();
    for (std::size_t p = 0; p < poses_.size(); ++p) quadrics_[to][p].add(quadrics_[from][p]);
    areas_[to] += areas_[from];
    ++ages_[from];
    ++ages_[to];
    for (const int v : neighbours(collapse.to)) propose(v, collapse.to), propose(collapse.to, v);
  }

  TriangleMesh compact() const {
    TriangleMesh mesh;
    std::vector<int> index(mesh_.vertices.size(), -1);
    for (const Triangle& triangle : mesh_.triangles) {
      if (triangle[0] < 0) continue;
      Triangle kept{};
      for (std::size_t i = 0; i < 3; ++i) {
        int& known = index[at(triangle[i])];
        if (known < 0) {
          known = static_cast<int>(mesh.vertices.size());
          mesh.vertices.push_back(mesh_.vertices[at(triangle[i])]);
        }
        kept[i] = known;
      }
      mesh.triangles.push_back(kept);
    }
    return mesh;
  }

  TriangleMesh mesh_;
  const std::vector<Places>& poses_;
  std::size_t left_;
  std::vector<std::vector<int>> around_;  // each vertex, its triangles
  std::vector<int> ages_;
  std::vector<double> areas_;
  std::vector<std::vector<Quadric>> quadrics_;  // of each vertex, in each pose
  std::vector<Places> normals_;                 // in each pose, of each vertex
  std::priority_queue<Collapse> queue_;
};

}  // namespace

TriangleMesh simplified(const TriangleMesh& mesh, const std::vector<Places>& poses,
                        const std::vector<double>& worth, std::size_t triangles) {
  return Simplifier(mesh, poses, worth).reduced_to(triangles);
}

}  // namespace mrhi
