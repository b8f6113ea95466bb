#include "flat_faces.h"

#include <algorithm>
#include <numeric>

namespace mrhi {
namespace {

/// Exactly the same place is one vertex; what is nearly so has been joined as the file was loaded, if it was.
bool before(const Vector3& a, const Vector3& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

/// A side by its ends, the lesser first, and then by its direction.
struct DirectedSide {
  int low, high;
  bool down;
  Neighbourhood::Side of;

  bool same_line(const DirectedSide& other) const { return low == other.low && high == other.high; }
  friend bool operator<(const DirectedSide& a, const DirectedSide& b) {
    return std::make_tuple(a.low, a.high, a.down, a.of.triangle) <
           std::make_tuple(b.low, b.high, b.down, b.of.triangle);
  }
};

std::vector<DirectedSide> sides_of(const TriangleMesh& mesh) {
  std::vector<DirectedSide> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int from = mesh.triangles[t][k], to = mesh.triangles[t][(k + 1) % 3];
      sides.push_back(
          {std::min(from, to), std::max(from, to), from > to, {static_cast<int>(t), static_cast<int>(k)}});
    }
  }
  std::sort(sides.begin(), sides.end());
  return sides;
}

}  // namespace

/// A triangle is turned to begin with its least vertex, which keeps its sense; what has lost a vertex by
/// joining has no area and goes.
TriangleMesh sorted(const TriangleMesh& mesh) {
  std::vector<char> used(mesh.vertices.size(), 0);
  for (const std::array<int, 3>& triangle : mesh.triangles)
    for (const int v : triangle) used[static_cast<std::size_t>(v)] = 1;
  std::vector<std::size_t> order(mesh.vertices.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return before(mesh.vertices[a], mesh.vertices[b]); });
  TriangleMesh result;
  std::vector<int> renamed(mesh.vertices.size(), -1);
  for (const std::size_t v : order) {
    if (used[v] == 0) continue;
    if (result.vertices.empty() || result.vertices.back() != mesh.vertices[v])
      result.vertices.push_back(mesh.vertices[v]);
    renamed[v] = static_cast<int>(result.vertices.size()) - 1;
  }
  for (std::array<int, 3> triangle : mesh.triangles) {
    for (int& v : triangle) v = renamed[static_cast<std::size_t>(v)];
    if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) continue;
    std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()), triangle.end());
    result.triangles.push_back(triangle);
  }
  std::sort(result.triangles.begin(), result.triangles.end());
  return result;
}

/// Of a closed surface whose triangles all face outwards each line has as many sides up as down. Sides of one
/// line pair up in the order of their triangles: more than two meet where bodies touch along an edge, and any
/// pairing closes it.
Neighbourhood::Neighbourhood(const TriangleMesh& mesh) : beyond_(mesh.triangles.size()) {
  const std::vector<DirectedSide> sides = sides_of(mesh);
  const auto set = [this](const Side& of, const Side& beyond) {
    beyond_[static_cast<std::size_t>(of.triangle)][static_cast<std::size_t>(of.side)] = beyond;
  };
  for (auto first = sides.begin(); first != sides.end();) {
    const auto last = std::find_if(first, sides.end(), [&](const auto& s) { return !s.same_line(*first); });
    auto up = first, down = std::find_if(first, last, [](const auto&s) { return s.down; });
    closed_ = closed_ && down - first == last - down;
    const auto end_of_up = down;
    for (; up != end_of_up && down != last; ++up, ++down) set(up->of, down->of), set(down->of, up->of);
    first = last;
  }
  find_pieces();
}

void Neighbourhood::find_pieces() {
  if (beyond_.empty()) return;
  std::vector<char> reached(beyond_.size(), 0);
  std::vector<int> open{0};
  reached[0] = 1;
  std::size_t count = 1;
  while (!open.empty()) {
    const int triangle = open.back();
    open.pop_back();
    for (const Side& next : beyond_[static_cast<std::size_t>(triangle)]) {
      if (!next.exists() || reached[static_cast<std::size_t>(next.triangle)] != 0) continue;
      reached[static_cast<std::size_t>(next.triangle)] = 1;
      open.push_back(next.triangle);
      ++count;
    }
  }
  one_piece_ = count == beyond_.size();
}

}  // namespace mrhi
