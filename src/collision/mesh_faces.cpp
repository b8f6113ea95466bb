#include "mesh_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <tuple>

namespace mrhi {
namespace {

/// Orders places; vertices that nearly coincide have been joined as the file was loaded, if at all.
bool before(const Vector3& a, const Vector3& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

/// A side of a triangle, from vertex `side` to the next.
struct Side {
  int triangle = -1, side = 0;
  bool exists() const { return triangle >= 0; }
};

/// Sides by their ends, the lesser first, then by their direction, then by their triangle.
struct DirectedSide {
  std::pair<int, int> ends;
  bool down;
  Side of;
};

std::vector<DirectedSide> sides_of(const TriangleMesh& mesh) {
  std::vector<DirectedSide> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int from = mesh.triangles[t][k], to = mesh.triangles[t][(k + 1) % 3];
      sides.push_back({std::minmax(from, to), from > to, {t, k}});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const DirectedSide& a, const DirectedSide& b) {
    return std::tie(a.ends, a.down, a.of.triangle) < std::tie(b.ends, b.down, b.of.triangle);
  });
  return sides;
}

/// The mesh with its vertices in the order of their places, those at one place joined, and its triangles in
/// the order of their vertices, each from its least vertex on: the same for any order in a file. Unused
/// vertices and triangles of joined vertices are dropped.
TriangleMesh sorted(const TriangleMesh& mesh) {
  std::vector<char> used(mesh.vertices.size(), 0);
  for (const std::array<int, 3>& triangle : mesh.triangles)
    for (const int v : triangle) used[v] = 1;
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
    for (int& v : triangle) v = renamed[v];
    if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) continue;
    std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()), triangle.end());
    result.triangles.push_back(triangle);
  }
  std::sort(result.triangles.begin(), result.triangles.end());
  return result;
}

/// The neighbouring triangle, and its side, at each of a triangle's three sides (from vertex k to the next).
class Neighbourhood {
 public:
  /// On a closed surface each line has as many sides up as down. They pair up in the order of their
  /// triangles: more than two meet where bodies touch along an edge, and any pairing closes it.
  explicit Neighbourhood(const TriangleMesh& mesh) : beyond_(mesh.triangles.size()) {
    const std::vector<DirectedSide> sides = sides_of(mesh);
    const auto set = [this](const Side& of, const Side& beyond) { beyond_[of.triangle][of.side] = beyond; };
    for (auto first = sides.begin(); first != sides.end();) {
      const auto last =
          std::find_if(first, sides.end(), [&](const auto& s) { return s.ends != first->ends; });
      auto up = first, down = std::find_if(first, last, [](const auto&s) { return s.down; });
      closed_ = closed_ && down - first == last - down;
      const auto end_of_up = down;
      for (; up != end_of_up && down != last; ++up, ++down) set(up->of, down->of), set(down->of, up->of);
      first = last;
    }
    find_pieces();
  }

  const Side& beyond(int triangle, int side) const {
    return beyond_[triangle][static_cast<std::size_t>(side)];
  }
  bool closed() const { return closed_; }        ///< every side has one beyond it, that runs the other way
  bool one_piece() const { return one_piece_; }  ///< every triangle is reached from every other

 private:
  void find_pieces() {
    if (beyond_.empty()) return;
    std::vector<char> reached(beyond_.size(), 0);
    std::vector<int> open{0};
    reached[0] = 1;
    std::size_t count = 1;
    while (!open.empty()) {
      const int triangle = open.back();
      open.pop_back();
      for (const Side& next : beyond_[triangle]) {
        if (!next.exists() || reached[next.triangle] != 0) continue;
        reached[next.triangle] = 1;
        open.push_back(next.triangle);
        ++count;
      }
    }
    one_piece_ = count == beyond_.size();
  }

  std::vector<std::array<Side, 3>> beyond_;
  bool closed_ = true, one_piece_ = true;
};

/// A plane fitted to triangles by their areas, as they are added. With A_i the doubled area vectors (edge x
/// edge, along the normal) and x_i the middles:
///     n = sum A_i / |sum A_i|,   height = n.(sum |A_i| x_i) / sum |A_i|.
/// For triangles in one plane that is exact; large ones outweigh the rounding of slivers, whose own normals
/// mean nothing.
class Plane {
 public:
  void add(const Vector3& doubled_area, const Vector3& centre) {
    const double weight = doubled_area.norm();
    area_ += doubled_area;
    moment_ += weight * centre;
    weight_ += weight;
    if (weight_ == 0.0) return;
    normal_ = area_.normalized();
    height_ = normal_.dot(moment_) / weight_;
  }
  double above(const Vector3& place) const { return normal_.dot(place) - height_; }
  const Vector3& normal() const { return normal_; }
  double height() const { return height_; }

 private:
  Vector3 area_ = Vector3::Zero(), moment_ = Vector3::Zero(), normal_ = Vector3::Zero();
  double weight_ = 0.0, height_ = 1e300;  // without an area it is near nothing
};

/// Cuts a surface along its edges into faces. Growing regions from the largest triangle down: the order is by
/// area, ties by the sorted mesh's order, so that a file's order does not count.
class FaceFinder {
 public:
  FaceFinder(const TriangleMesh& mesh, const Neighbourhood& neighbourhood, double tolerance)
      : mesh_(mesh),
        neighbourhood_(neighbourhood),
        tolerance_(tolerance),
        areas_(mesh.triangles.size()),
        face_of_(mesh.triangles.size(), -1) {
    std::vector<int> order(mesh.triangles.size());
    std::iota(order.begin(), order.end(), 0);
    for (std::size_t t = 0; t < areas_.size(); ++t) {
      const auto corner = [&](std::size_t i) { return mesh.vertices[mesh.triangles[t][i]]; };
      areas_[t] = (corner(1) - corner(0)).cross(Vector3(corner(2) - corner(0)));
    }
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return areas_[a].squaredNorm() > areas_[b].squaredNorm(); });
    if (order.empty() || areas_[order.front()].norm() == 0.0)
      throw std::invalid_argument("mesh has no triangle with an area");
    for (const int triangle : order) {
      if (face_of_[triangle] < 0) grow(triangle);
    }
  }

  const std::vector<Plane>& planes() const { return planes_; }
  int face_of(int triangle) const { return face_of_[triangle]; }

 private:
  const Vector3& corner(int triangle, int i) const {
    return mesh_.vertices[mesh_.triangles[triangle][i % 3]];
  }

  /// Adds coplanar neighbours. Each triangle must lie on the plane of all taken so far, not only beside its
  /// neighbour: on a fine curve neighbours are nearly coplanar all the way round.
  void grow(int seed) {
    const int face = static_cast<int>(planes_.size());
    planes_.emplace_back();
    take(seed, face);
    std::vector<int> open{seed};
    for (std::size_t next = 0; next < open.size(); ++next) {
      for (int side = 0; side < 3; ++side) {
        const Side beyond = neighbourhood_.beyond(open[next], side);
        if (!beyond.exists() || face_of_[beyond.triangle] >= 0) continue;
        if (!is_coplanar(open[next], side, beyond) || !on_plane(beyond.triangle, planes_.back())) continue;
        take(beyond.triangle, face);
        open.push_back(beyond.triangle);
      }
    }
  }
  void take(int triangle, int face) {
    face_of_[triangle] = face;
    const Vector3 centre = (corner(triangle, 0) + corner(triangle, 1) + corner(triangle, 2)) / 3.0;
    planes_.back().add(areas_[triangle], centre);
  }

  /// True if two neighbouring triangles are in one plane, or one is too thin to have a direction of its own.
  /// Tests the smaller height of one's apex above the other's plane, A.(apex - corner) / |A|: a length, like
  /// the tolerance. An angle would be too strict for slivers, whose apex is near the shared side. Triangles
  /// that face each other (A.B <= 0) are a fold.
  bool is_coplanar(int triangle, int side, const Side& beyond) const {
    if (is_needle(beyond.triangle, beyond.side) || is_needle(triangle, side)) return true;
    const Vector3 &area = areas_[triangle], &other = areas_[beyond.triangle];
    if (area.dot(other) <= 0.0) return false;
    const Vector3 apex = corner(triangle, side + 2), other_apex = corner(beyond.triangle, beyond.side + 2);
    const Vector3 across = other_apex - apex;
    const Vector3 on_side = corner(triangle, side) - apex;
    const double rise = std::abs(area.dot(across) - area.dot(on_side)) / area.norm();
    const double other_rise = std::abs(other.dot(on_side)) / other.norm();
    return std::min(rise, other_rise) <= tolerance_;
  }
  /// Doubled area / side = height of the apex above it: a thousandth of the tolerance is no height.
  bool is_needle(int triangle, int side) const {
    const double length = (corner(triangle, side + 1) - corner(triangle, side)).norm();
    return areas_[triangle].norm() <= tolerance_ * 1e-3 * length;
  }
  bool on_plane(int triangle, const Plane& plane) const {
    for (int i = 0; i < 3; ++i)
      if (std::abs(plane.above(corner(triangle, i))) > tolerance_) return false;
    return true;
  }

  const TriangleMesh& mesh_;
  const Neighbourhood& neighbourhood_;
  const double tolerance_;
  std::vector<Vector3> areas_;  // doubled
  std::vector<Plane> planes_;
  std::vector<int> face_of_;
};

/// A line along which two faces meet, from corner to corner: vertices in the order of the first face's side.
struct Seam {
  int face, other;  // -1 where there is none
  std::vector<int> vertices;
};

/// Follows the lines between faces, and leaves out the vertices on their straight parts.
class SeamFinder {
 public:
  SeamFinder(const TriangleMesh& mesh, const Neighbourhood& neighbourhood, const FaceFinder& faces,
             double tolerance)
      : mesh_(mesh), tolerance_(tolerance), around_(mesh.vertices.size()) {
    for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
      for (int k = 0; k < 3; ++k) {
        const Side beyond = neighbourhood.beyond(t, k);
        const int face = faces.face_of(t), other = beyond.exists() ? faces.face_of(beyond.triangle) : -1;
        const bool twice =
            beyond.exists() && std::make_pair(beyond.triangle, beyond.side) < std::make_pair(t, k);
        if (face == other || twice) continue;
        const std::array<int, 3>& triangle = mesh.triangles[t];
        pieces_.push_back({triangle[k], triangle[(k + 1) % 3], face, other, false});
        for (const int end : {pieces_.back().from, pieces_.back().to})
          around_[end].push_back(static_cast<int>(pieces_.size()) - 1);
      }
    }
    for (int v = 0; v < static_cast<int>(around_.size()); ++v)
      if (!is_within_seam(v)) follow_from(v);
    for (std::size_t p = 0; p < pieces_.size(); ++p)  // what is left are rings
      if (!pieces_[p].followed) follow(static_cast<int>(p), pieces_[p].from);
  }

  const std::vector<Seam>& seams() const { return seams_; }

 private:
  struct Piece {
    int from, to, face, other;
    bool followed;
  };

  /// True if two pieces meet here between the same two faces, or none, within a face.
  bool is_within_seam(int vertex) const {
    const std::vector<int>& pieces = around_[vertex];
    if (pieces.size() != 2) return pieces.empty();
    const Piece &a = pieces_[pieces[0]], &b = pieces_[pieces[1]];
    return std::minmax(a.face, a.other) == std::minmax(b.face, b.other);
  }
  void follow_from(int corner) {
    for (const int piece : around_[corner])
      if (!pieces_[piece].followed) follow(piece, corner);
  }
  /// From corner to corner, in either direction; the seam is turned round at the end if it began against its
  /// first piece, so that its first face is on its left.
  void follow(int piece, int start) {
    Seam seam{pieces_[piece].face, pieces_[piece].other, {start}};
    const bool along = pieces_[piece].from == start;
    for (int vertex = start; piece >= 0;) {
      Piece& now = pieces_[piece];
      now.followed = true;
      vertex = now.from == vertex ? now.to : now.from;
      seam.vertices.push_back(vertex);
      piece = -1;
      if (!is_within_seam(vertex)) break;
      for (const int next : around_[vertex])
        if (!pieces_[next].followed) piece = next;
    }
    if (!along) std::reverse(seam.vertices.begin(), seam.vertices.end());
    straighten(seam.vertices);
    seams_.push_back(std::move(seam));
  }

  /// Keeps the vertex that is farthest from the line between those kept, while it is off it (Douglas &
  /// Peucker 1973). A ring is two lines, between two distant vertices.
  void straighten(std::vector<int>& line) const {
    std::vector<char> kept(line.size(), 0);
    kept.front() = kept.back() = 1;
    if (line.front() == line.back()) {
      const std::size_t middle = farthest(line, 0, line.size() - 1).first;
      kept[middle] = 1;
      keep(line, 0, middle, kept), keep(line, middle, line.size() - 1, kept);
    } else {
      keep(line, 0, line.size() - 1, kept);
    }
    std::size_t count = 0;
    for (std::size_t i = 0; i < line.size(); ++i)
      if (kept[i] != 0) line[count++] = line[i];
    line.resize(count);
  }
  void keep(const std::vector<int>& line, std::size_t first, std::size_t last,
            std::vector<char>& kept) const {
    std::vector<std::pair<std::size_t, std::size_t>> open{{first, last}};
    while (!open.empty()) {
      const auto [from, to] = open.back();
      open.pop_back();
      const auto [i, distance] = farthest(line, from, to);
      if (distance <= tolerance_) continue;
      kept[i] = 1;
      open.emplace_back(from, i), open.emplace_back(i, to);
    }
  }
  /// From a half line, `part` >= 0: else a line that doubles back would seem straight.
  std::pair<std::size_t, double> farthest(const std::vector<int>& line, std::size_t from,
                                          std::size_t to) const {
    const Vector3& start = mesh_.vertices[line[from]];
    const Vector3 along = (mesh_.vertices[line[to]] - start).normalized();
    std::pair<std::size_t, double> found{from, 0.0};
    for (std::size_t i = from + 1; i < to; ++i) {
      const Vector3 offset = mesh_.vertices[line[i]] - start;
      const double part = std::max(0.0, along.dot(offset));
      const double distance = (offset - part * along).norm();
      if (distance > found.second) found = {i, distance};
    }
    return found;
  }

  const TriangleMesh& mesh_;
  const double tolerance_;
  std::vector<std::vector<int>> around_;  // each vertex, the pieces
  std::vector<Piece> pieces_;
  std::vector<Seam> seams_;
};

/// Angle at a triangle's corner: normals of the faces around a vertex, weighted by it, do not depend on how
/// the faces are cut into triangles (Thuermer & Wuethrich 1998), and tell inside from outside (Baerentzen &
/// Aanaes 2005).
double corner_angle(const Vector3& a, const Vector3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

///     N = sum angle_i n_i   over the triangles around the vertex, of any length
std::vector<Vector3> vertex_normals(const TriangleMesh& mesh, const FaceFinder& faces) {
  std::vector<Vector3> normals(mesh.vertices.size(), Vector3::Zero());
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    const std::array<int, 3>& triangle = mesh.triangles[t];
    const Vector3& normal = faces.planes()[faces.face_of(t)].normal();
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3& corner = mesh.vertices[triangle[i]];
      normals[triangle[i]] += corner_angle(mesh.vertices[triangle[(i + 1) % 3]] - corner,
                                           mesh.vertices[triangle[(i + 2) % 3]] - corner) *
                              normal;
    }
  }
  return normals;
}

}  // namespace

FlatFaces merge_coplanar_triangles(const TriangleMesh& unsorted) {
  const TriangleMesh mesh = sorted(unsorted);
  const Neighbourhood neighbourhood(mesh);
  Eigen::AlignedBox3d box;
  for (const Vector3& v : mesh.vertices) box.extend(v);
  const double tolerance = kFlatness * box.sizes().maxCoeff();
  const FaceFinder faces(mesh, neighbourhood, tolerance);
  const SeamFinder lines(mesh, neighbourhood, faces, tolerance);

  FlatFaces result;
  result.closed = neighbourhood.closed();
  result.one_piece = neighbourhood.one_piece();
  for (const Plane& plane : faces.planes()) result.faces.push_back({plane.normal(), plane.height()});
  std::vector<int> corner_of(mesh.vertices.size(), -1);
  for (const Seam& seam : lines.seams())
    for (const int v : seam.vertices) corner_of[v] = 0;
  const std::vector<Vector3> normals = vertex_normals(mesh, faces);
  for (std::size_t v = 0; v < corner_of.size(); ++v) {
    if (corner_of[v] < 0) continue;
    corner_of[v] = static_cast<int>(result.corners.size());
    result.corners.push_back(mesh.vertices[v]);
    result.corner_normals.push_back(normals[v]);
  }
  for (const Seam& seam : lines.seams()) {
    for (std::size_t i = 1; i < seam.vertices.size(); ++i) {
      const int from = seam.vertices[i - 1], to = seam.vertices[i];
      result.edges.push_back({mesh.vertices[from],
                              mesh.vertices[to] - mesh.vertices[from],
                              {{corner_of[from], corner_of[to]}},
                              {{seam.face, seam.other < 0 ? seam.face : seam.other}}});
    }
  }
  return result;
}

}  // namespace mrhi
