#include "solid_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace mrhi {
namespace {

const char* const kNoVolume = "has no volume; allowed for collision: a surface around a volume";

using Triangle = std::array<int, 3>;
using Triangles = std::vector<Triangle>;

/// Distances at which vertices are joined if that closes the surface, over the mesh's extent: first gaps from
/// rounding, then those that exporters leave.
constexpr double kWeldDistances[] = {1e-6, 1e-5, 1e-4};
/// Largest width of a hole that is filled, over the extent.
constexpr double kMaxFilledHole = 0.05;
/// Smallest volume of a solid, over the cube of its extent.
constexpr double kMinVolume = 1e-9;

Vector3 corner(const TriangleMesh& mesh, const Triangle& triangle, std::size_t k) {
  return mesh.vertices[triangle[k]];
}

double extent_of(const TriangleMesh& mesh, const Triangles& triangles) {
  return triangles.empty() ? 0.0 : box_around(mesh, triangles).sizes().maxCoeff();
}

double volume_of(const TriangleMesh& mesh, const Triangles& triangles) {
  double volume = 0.0;
  for (const Triangle& t : triangles) {
    const Vector3 &origin = mesh.vertices[0], a = corner(mesh, t, 0);
    volume += (corner(mesh, t, 1) - a).cross(corner(mesh, t, 2) - a).dot(a - origin) / 6.0;
  }
  return volume;
}

/// An edge: number of triangles that run along it from its lower vertex to the higher, minus those that run
/// back; and indices of all of them.
struct Edge {
  int balance = 0;
  std::vector<int> triangles;
};
using Edges = std::map<std::pair<int, int>, Edge>;

Edges edges_of(const Triangles& triangles) {
  Edges edges;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int from = triangles[t][k], to = triangles[t][(k + 1) % 3];
      Edge& edge = edges[std::minmax(from, to)];
      edge.balance += from < to ? 1 : -1;
      edge.triangles.push_back(static_cast<int>(t));
    }
  }
  return edges;
}

bool is_closed(const Triangles& triangles) {
  const Edges edges = edges_of(triangles);
  return std::all_of(edges.begin(), edges.end(), [](const auto& edge) { return edge.second.balance == 0; });
}

bool is_solid(const TriangleMesh& mesh, const Triangles& part) {
  const double extent = extent_of(mesh, part);
  return std::abs(volume_of(mesh, part)) > kMinVolume * extent * extent * extent && is_closed(part);
}

/// Joins vertices at max_triangles `distance` apart, and drops triangles that become degenerate.
void weld(TriangleMesh& mesh, double distance) {
  using Cell = std::array<long long, 3>;
  std::map<Cell, std::vector<int>> cells;
  std::vector<int> same(mesh.vertices.size());
  const auto cell_of = [&](const Vector3& place) -> Cell {
    return {{static_cast<long long>(std::floor(place.x() / distance)),
             static_cast<long long>(std::floor(place.y() / distance)),
             static_cast<long long>(std::floor(place.z() / distance))}};
  };
  const auto first_near = [&](const Vector3& place, int otherwise) {
    const Cell middle = cell_of(place);
    for (int i = 0; i < 27; ++i) {
      const auto found =
          cells.find({{middle[0] + i % 3 - 1, middle[1] + i / 3 % 3 - 1, middle[2] + i / 9 - 1}});
      if (found == cells.end()) continue;
      for (const int v : found->second)
        if (v < otherwise && (mesh.vertices[v] - place).norm() <= distance) otherwise = v;
    }
    return otherwise;
  };
  for (int v = 0; v < static_cast<int>(mesh.vertices.size()); ++v) {
    same[v] = first_near(mesh.vertices[v], v);
    if (same[v] == v) cells[cell_of(mesh.vertices[v])].push_back(v);
  }
  for (Triangle& triangle : mesh.triangles)
    for (int& v : triangle) v = same[v];
  mesh.triangles.erase(std::remove_if(mesh.triangles.begin(), mesh.triangles.end(), is_degenerate),
                       mesh.triangles.end());
}

/// Keeps the first of all triangles on the same three vertices, whatever their orientation.
Triangles without_doubled(const Triangles& triangles) {
  std::map<Triangle, bool> seen;
  Triangles kept;
  for (const Triangle& triangle : triangles) {
    Triangle key = triangle;
    std::sort(key.begin(), key.end());
    if (seen.emplace(key, true).second) kept.push_back(triangle);
  }
  return kept;
}

std::set<int> vertices_of(const Triangles& triangles) {
  std::set<int> vertices;
  for (const Triangle& t : triangles) vertices.insert(t.begin(), t.end());
  return vertices;
}

/// Parts that are connected by edges of two triangles, each with the orientation of its first triangle.
std::vector<Triangles> parts_of(const Triangles& triangles) {
  const Edges edges = edges_of(triangles);
  std::vector<Triangles> parts;
  std::vector<char> reached(triangles.size(), 0);
  Triangles turned = triangles;
  for (std::size_t first = 0; first < triangles.size(); ++first) {
    if (reached[first]) continue;
    std::vector<int> open{static_cast<int>(first)}, part;
    reached[first] = 1;
    while (!open.empty()) {
      const int now = open.back();
      open.pop_back();
      part.push_back(now);
      const Triangle here = turned[now];
      for (std::size_t k = 0; k < 3; ++k) {
        const int from = here[k], to = here[(k + 1) % 3];
        const Edge& edge = edges.at(std::minmax(from, to));
        if (edge.triangles.size() != 2) continue;
        const int next = edge.triangles[0] == now ? edge.triangles[1] : edge.triangles[0];
        if (reached[next]) continue;
        reached[next] = 1;
        open.push_back(next);
        Triangle& there = turned[next];
        for (std::size_t j = 0; j < 3; ++j)
          if (there[j] == from && there[(j + 1) % 3] == to) {
            std::swap(there[1], there[2]);
            break;
          }
      }
    }
    std::sort(part.begin(), part.end());
    parts.emplace_back();
    for (const int t : part) parts.back().push_back(turned[t]);
  }
  return parts;
}

/// Keeps the first of all patches with the same vertices and border: the two sides of a doubled face may be
/// divided into different triangles. With `cancel`, a pair of patches is dropped entirely.
Triangles without_doubled_patches(const std::vector<Triangles>& patches, bool cancel) {
  std::map<std::pair<std::set<int>, std::set<std::pair<int, int>>>, std::vector<std::size_t>> same;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    std::set<std::pair<int, int>> border;
    for (const auto& [ends, edge] : edges_of(patches[p]))
      if (edge.triangles.size() == 1) border.insert(ends);
    same[{vertices_of(patches[p]), border}].push_back(p);
  }
  std::set<std::size_t> kept;
  for (const auto& [key, doubled] : same)
    if (!cancel || doubled.size() != 2) kept.insert(doubled.front());
  Triangles left;
  for (const std::size_t p : kept) left.insert(left.end(), patches[p].begin(), patches[p].end());
  return left;
}

/// Divides triangles where a border vertex lies on one of their edges: CAD programs mesh adjacent faces at
/// different resolutions (T-junctions).
Triangles divided_at_border(const TriangleMesh& mesh, Triangles triangles, double distance) {
  constexpr std::size_t kMaxBorder = 4000;  // edges: each is compared with all others
  const std::size_t max_triangles = 2 * triangles.size() + kMaxBorder;
  for (bool divides = true; divides && triangles.size() < max_triangles;) {
    divides = false;
    std::vector<std::pair<int, int>> border;
    for (const auto& [ends, edge] : edges_of(triangles))
      if (edge.balance != 0) border.push_back(ends);
    if (border.size() > kMaxBorder) break;
    Triangles divided;
    for (const Triangle& triangle : triangles) {
      int on_edge = -1;
      std::size_t k = 0;
      for (; k < 3 && on_edge < 0; ++k) {
        const int from = triangle[k], to = triangle[(k + 1) % 3];
        const std::pair<int, int> ends = std::minmax(from, to);
        if (!std::binary_search(border.begin(), border.end(), ends)) continue;
        const Vector3 a = mesh.vertices[from], along = mesh.vertices[to] - a;
        const double length = along.norm();
        for (const auto& other : border)
          for (const int v : {other.first, other.second}) {
            const Vector3 from_a = mesh.vertices[v] - a;
            const double s = from_a.dot(along) / length;
            if (s > distance && s < length - distance && from_a.cross(along).norm() < distance * length)
              on_edge = v;
          }
      }
      if (on_edge < 0) {
        divided.push_back(triangle);
        continue;
      }
      divides = true;
      const int from = triangle[k - 1], to = triangle[k % 3], opposite = triangle[(k + 1) % 3];
      if (on_edge != opposite)
        divided.insert(divided.end(), {{{from, on_edge, opposite}}, {{on_edge, to, opposite}}});
    }
    triangles = divided;
  }
  return triangles;
}

/// Fills the holes of a part that are small or lack one triangle with fans. Returns true if a hole that is
/// not small was filled.
bool fill_holes(const TriangleMesh& mesh, Triangles& part) {
  const double widest = kMaxFilledHole * extent_of(mesh, part);
  std::map<int, int> next;  // along the border
  for (const auto& [ends, edge] : edges_of(part)) {
    if (edge.balance == 0) continue;
    const bool up = edge.balance > 0;
    if (!next.emplace(up ? ends.second : ends.first, up ? ends.first : ends.second).second) return false;
  }
  bool large = false;
  while (!next.empty()) {
    std::vector<int> loop;
    Eigen::AlignedBox3d box;
    for (auto at = next.begin(); at != next.end(); at = next.find(loop.back())) {
      box.extend(mesh.vertices[at->first]);
      loop.push_back(at->second);
      next.erase(at);
    }
    const bool small = box.sizes().norm() <= widest;
    if (loop.size() < 3 || (loop.size() > 3 && !small)) continue;
    large = large || !small;
    for (std::size_t i = 2; i < loop.size(); ++i) part.push_back({{loop[0], loop[i - 1], loop[i]}});
  }
  return large;
}

/// The solid angle of a closed part is 4 pi as seen from inside, and 0 from outside (van Oosterom & Strackee
/// 1983).
bool is_inside(const TriangleMesh& mesh, const Triangles& part, const Vector3& place) {
  double angle = 0.0;
  for (const Triangle& t : part) {
    const Vector3 a = corner(mesh, t, 0) - place, b = corner(mesh, t, 1) - place,
                  c = corner(mesh, t, 2) - place;
    const double x = a.norm(), y = b.norm(), z = c.norm();
    angle += 2.0 * std::atan2(a.dot(b.cross(c)), x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y);
  }
  return std::abs(angle) > 6.283185307179586;
}

/// True if a sample of its corners is inside the other part.
bool is_within(const TriangleMesh& mesh, const Triangles& part, const Triangles& other) {
  constexpr std::size_t kSamples = 16;
  const std::size_t step = std::max<std::size_t>(1, part.size() / kSamples);
  for (std::size_t t = 0; t < part.size(); t += step)
    if (!is_inside(mesh, other, corner(mesh, part[t], 0))) return false;
  return true;
}

/// A closed part and its cavities.
struct Solid {
  Triangles triangles;
  bool inward;  // orientation in the file
  std::vector<Triangles> cavities;
};

/// Sorts the parts by volume, largest first. A part inside another one is its cavity if it has the opposite
/// orientation, else a solid of its own.
std::vector<Solid> nested(const TriangleMesh& mesh, std::vector<Triangles> parts) {
  std::vector<std::pair<double, Triangles*>> by_size;
  by_size.reserve(parts.size());
  for (Triangles& part : parts) by_size.emplace_back(-std::abs(volume_of(mesh, part)), &part);
  std::stable_sort(by_size.begin(), by_size.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Solid> solids;
  for (const auto& sized : by_size) {
    Triangles& part = *sized.second;
    const bool inward = volume_of(mesh, part) < 0.0;
    const auto around = std::find_if(solids.begin(), solids.end(), [&](const Solid& solid) {
      return is_within(mesh, part, solid.triangles) &&
             std::none_of(solid.cavities.begin(), solid.cavities.end(),
                          [&](const Triangles& cavity) { return is_within(mesh, part, cavity); });
    });
    if (around != solids.end() && inward == around->inward) continue;
    for (Triangle& t : part)
      if (inward == (around == solids.end())) std::swap(t[1], t[2]);
    if (around == solids.end()) {
      solids.push_back({part, inward, {}});
    } else {
      around->cavities.push_back(part);
    }
  }
  return solids;
}

void put(std::vector<Triangles> parts, TriangleMesh& mesh) {
  mesh.triangles.clear(), mesh.parts.clear();
  for (const Solid& solid : nested(mesh, std::move(parts))) {
    mesh.parts.push_back(static_cast<int>(mesh.triangles.size()));
    for (const Triangle& t : solid.triangles) mesh.triangles.push_back(t);
    for (const Triangles& cavity : solid.cavities)
      mesh.triangles.insert(mesh.triangles.end(), cavity.begin(), cavity.end());
  }
  const bool overlap = mesh.parts.size() > 1 && shared_moments(mesh, signed_volume(mesh)).volume > 0.0;
  if (!overlap) mesh.parts.clear();
}

bool are_solid(const TriangleMesh& mesh, const std::vector<Triangles>& parts) {
  return !parts.empty() &&
         std::all_of(parts.begin(), parts.end(), [&](const Triangles& part) { return is_solid(mesh, part); });
}

/// Sets the mesh to the solid parts and the hull of those that remain open. Flat sheets, which have no hull,
/// are left out.
std::vector<std::string> put_with_hull(std::vector<Triangles> parts, TriangleMesh& mesh) {
  std::vector<Triangles> solids;
  Triangles open;
  bool left_out = false, filled = false;
  for (Triangles& part : parts) {
    const bool large = !is_solid(mesh, part) && fill_holes(mesh, part);
    if (!is_solid(mesh, part)) continue;
    solids.push_back(part);
    filled = filled || large;
  }
  for (const Triangles& part : parts) {
    if (is_solid(mesh, part)) continue;
    bool flat = false;
    if (!solids.empty()) {
      try {
        convex_hull(cut_out(mesh, part));
      } catch (const NoVolume&) {
        flat = true;
      }
    }
    left_out = left_out || flat;
    if (!flat) open.insert(open.end(), part.begin(), part.end());
  }
  std::vector<std::string> assumed;
  if (left_out) assumed.push_back("has flat sheets, which are left out");
  if (filled) assumed.push_back("is not closed: triangles that it lacks are added");
  if (!open.empty()) {
    const auto first = static_cast<std::ptrdiff_t>(mesh.triangles.size());
    append(convex_hull(cut_out(mesh, open)), Pose{}, mesh);
    solids.emplace_back(mesh.triangles.begin() + first, mesh.triangles.end());
    assumed.push_back("is not closed: its convex hull is taken");
  }
  put(solids, mesh);
  const TriangleMesh used =
      cut_out(mesh, mesh.triangles);  // without unused vertices, which would enlarge the shape
  mesh.vertices = used.vertices, mesh.triangles = used.triangles;
  return assumed;
}

}  // namespace

TriangleMesh cut_out(const TriangleMesh& mesh, const std::vector<std::array<int, 3>>& triangles) {
  TriangleMesh part;
  std::map<int, int> renamed;
  for (Triangle triangle : triangles) {
    for (int& v : triangle) {
      const auto known = renamed.emplace(v, static_cast<int>(part.vertices.size()));
      if (known.second) part.vertices.push_back(mesh.vertices[v]);
      v = known.first->second;
    }
    part.triangles.push_back(triangle);
  }
  return part;
}

double signed_volume(const TriangleMesh& mesh) {
  return mesh.vertices.empty() ? 0.0 : volume_of(mesh, mesh.triangles);
}

std::vector<std::string> make_solid(TriangleMesh& mesh) {
  mesh.parts.clear();
  const auto put_if_solid = [&](const TriangleMesh& candidate, const std::vector<Triangles>& parts) {
    if (!are_solid(candidate, parts)) return false;
    mesh.vertices = candidate.vertices;
    put(parts, mesh);
    return true;
  };
  if (is_solid(mesh, mesh.triangles) && put_if_solid(mesh, parts_of(mesh.triangles))) return {};
  const double extent = extent_of(mesh, mesh.triangles);
  if (!(extent > 0.0)) throw NoVolume(kNoVolume);
  TriangleMesh best = mesh;
  for (const double seam : kWeldDistances) {
    TriangleMesh welded = mesh;
    weld(welded, seam * extent);
    const std::vector<Triangles> as_they_are = parts_of(welded.triangles);
    if (is_closed(welded.triangles) && put_if_solid(welded, as_they_are)) return {};
    welded.triangles = without_doubled(welded.triangles);
    const std::vector<Triangles> parts = parts_of(welded.triangles);
    if (put_if_solid(welded, parts)) return {};
    const Triangles joined = without_doubled_patches(as_they_are, true);  // joins solids that share faces
    const bool whole = vertices_of(joined) == vertices_of(welded.triangles);
    if (whole && put_if_solid(welded, parts_of(joined))) return {};
    welded.triangles = without_doubled_patches(parts, false);
    if (put_if_solid(welded, parts_of(welded.triangles))) return {};
    if (seam == kWeldDistances[0]) best = welded;
  }
  mesh = best;
  mesh.triangles = divided_at_border(mesh, mesh.triangles, kWeldDistances[2] * extent);
  std::vector<std::string> warnings = put_with_hull(parts_of(mesh.triangles), mesh);
  const auto has_area = [&](const Triangle& t) {
    const Vector3 a = corner(mesh, t, 0);
    return (corner(mesh, t, 1) - a).cross(corner(mesh, t, 2) - a).norm() > 0.0;
  };
  if (std::none_of(mesh.triangles.begin(), mesh.triangles.end(), has_area)) throw NoVolume(kNoVolume);
  return warnings;
}

std::vector<PlacedShape> with_meshes_joined(const std::vector<PlacedShape>& shapes) {
  if (std::count_if(shapes.begin(), shapes.end(), mesh_of) < 2) return shapes;
  std::vector<PlacedShape> joined;
  auto all = std::make_shared<TriangleMesh>();
  for (const PlacedShape& placed : shapes) {
    const TriangleMesh* const mesh = mesh_of(placed);
    if (mesh == nullptr) {
      joined.push_back(placed);
      continue;
    }
    const int first = static_cast<int>(all->triangles.size());
    for (const int part : mesh->parts.empty() ? std::vector<int>{0} : mesh->parts)
      all->parts.push_back(first + part);
    append(*mesh, placed.pose, *all);
  }
  joined.push_back({Mesh{all, "", Vector3::Ones()}, Pose{}});
  return joined;
}

}  // namespace mrhi
