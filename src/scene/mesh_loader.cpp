#include "mesh_loader.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <new>
#include <stdexcept>

#include "../text/limited_child.h"
#include "../text/text.h"

namespace mrhi {
namespace {

/// Vertices nearer to each other than this part of the mesh's extent are one, if that closes a surface.
constexpr double kSeam = 1e-6;

/// Gathers the triangles of a scene graph into one mesh.
class Collector {
 public:
  explicit Collector(const Vector3& scale) : scale_(scale) {}

  void add(const aiScene& scene, const aiNode& node, const aiMatrix4x4& parent) {
    const aiMatrix4x4 transform = parent * node.mTransformation;
    const bool mirrored = (transform.Determinant() < 0) != (scale_.prod() < 0);
    for (unsigned i = 0; i < node.mNumMeshes; ++i) add(*scene.mMeshes[node.mMeshes[i]], transform, mirrored);
    for (unsigned i = 0; i < node.mNumChildren; ++i) add(scene, *node.mChildren[i], transform);
  }

  TriangleMesh take() { return std::move(mesh_); }

 private:
  void add(const aiMesh& part, const aiMatrix4x4& transform, bool mirrored) {
    for (unsigned i = 0; i < part.mNumFaces; ++i) {
      const aiFace& face = part.mFaces[i];
      if (face.mNumIndices != 3) continue;
      std::array<int, 3> triangle;
      for (int k = 0; k < 3; ++k) triangle[k] = vertex(transform * part.mVertices[face.mIndices[k]]);
      if (mirrored) std::swap(triangle[1], triangle[2]);
      const bool is_point_or_line =
          triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0];
      if (!is_point_or_line) mesh_.triangles.push_back(triangle);
    }
  }

  int vertex(const aiVector3D& place) {
    // What is no number is as good as equal to any other, and would be taken for a vertex that is known.
    if (!std::isfinite(place.x) || !std::isfinite(place.y) || !std::isfinite(place.z))
      throw std::runtime_error("has a vertex that is not finite; allowed: finite numbers");
    const auto inserted = known_.emplace(std::array<ai_real, 3>{{place.x, place.y, place.z}},
                                         static_cast<int>(mesh_.vertices.size()));
    if (inserted.second) mesh_.vertices.push_back(scale_.cwiseProduct(Vector3(place.x, place.y, place.z)));
    return inserted.first->second;
  }

  Vector3 scale_;
  TriangleMesh mesh_;
  std::map<std::array<ai_real, 3>, int> known_;
};

Vector3 extent_of(const TriangleMesh& mesh) {
  Vector3 extent = Vector3::Zero();
  for (const Vector3& vertex : mesh.vertices)
    extent = extent.cwiseMax((vertex - mesh.vertices[0]).cwiseAbs());
  return extent;
}

/// Joins vertices that are no farther apart than `distance` with the first of them, and drops the triangles
/// that vanish.
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
  const auto vanishes = [](const std::array<int, 3>& t) {
    return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
  };
  for (std::array<int, 3>& triangle : mesh.triangles)
    for (int& v : triangle) v = same[v];
  mesh.triangles.erase(std::remove_if(mesh.triangles.begin(), mesh.triangles.end(), vanishes),
                       mesh.triangles.end());
}

Vector3 doubled_area(const TriangleMesh& mesh, const std::array<int, 3>& triangle) {
  const Vector3& a = mesh.vertices[triangle[0]];
  return (mesh.vertices[triangle[1]] - a).cross(mesh.vertices[triangle[2]] - a);
}

/// Edges that do not belong to two triangles, once in each direction.
int count_open_edges(const TriangleMesh& mesh) {
  std::map<std::pair<int, int>, int> balance;
  for (const std::array<int, 3>& triangle : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      const int from = triangle[k], to = triangle[(k + 1) % 3];
      balance[std::minmax({from, to})] += from < to ? 1 : -1;
    }
  }
  return static_cast<int>(
      std::count_if(balance.begin(), balance.end(), [](const auto& edge) { return edge.second != 0; }));
}

void check_format(const std::string& file) {
  std::string extension = std::filesystem::path(file).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (extension == ".stl" || extension == ".obj" || extension == ".dae") return;
  throw std::runtime_error("is of the format '" + extension + "'; allowed: .stl, .obj, .dae");
}

/// What a mesh may cost to read. The largest that have triangles within the limit are read in a second or
/// two.
constexpr std::uintmax_t kMostBytes = 64u << 20;
constexpr std::size_t kMostTriangles = 500'000;
constexpr ChildLimits kLimits{20, std::size_t(1) << 30, std::size_t(64) << 20};

void check_size(const std::string& file) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error || size <= kMostBytes) return;
  throw std::runtime_error("has " + std::to_string(size) + " bytes; allowed: at most " +
                           std::to_string(kMostBytes));
}

template <class Item>
void append(const std::vector<Item>& items, std::string& bytes) {
  const std::uint64_t count = items.size();
  bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
  bytes.append(reinterpret_cast<const char*>(items.data()), count * sizeof(Item));
}

template <class Item>
std::vector<Item> taken(const std::string& bytes, std::size_t& at) {
  std::uint64_t count = 0;
  std::memcpy(&count, &bytes.at(at), sizeof count);
  std::vector<Item> items(count);
  if (count > 0)
    std::memcpy(static_cast<void*>(items.data()), &bytes[at + sizeof count], count * sizeof(Item));
  at += sizeof count + count * sizeof(Item);
  return items;
}

/// Assimp reads what is given to it without any limit, and a small file may stand for an endless scene.
TriangleMesh read_by_assimp(const std::string& file, const Vector3& scale) {
  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFile(file, aiProcess_Triangulate);
  const std::string problem = importer.GetErrorString();
  if (problem.find("bad_alloc") != std::string::npos) throw std::bad_alloc();
  if (!scene || !scene->mRootNode) {
    throw std::runtime_error("cannot be read: " + text::one_line(problem, 120) +
                             "; allowed: a whole STL, OBJ or DAE file");
  }
  Collector collector(scale);
  collector.add(*scene, *scene->mRootNode, aiMatrix4x4());
  return collector.take();
}

}  // namespace

TriangleMesh load_mesh(const std::string& file, const Vector3& scale) {
  check_format(file);
  check_size(file);
  const std::string bytes = run_in_child(kLimits, [&] {
    const TriangleMesh mesh = read_by_assimp(file, scale);
    if (mesh.triangles.size() > kMostTriangles)
      throw std::runtime_error("has " + std::to_string(mesh.triangles.size()) +
                               " triangles; allowed: at most " + std::to_string(kMostTriangles));
    std::string all;
    append(mesh.vertices, all);
    append(mesh.triangles, all);
    return all;
  });
  std::size_t at = 0;
  TriangleMesh mesh;
  mesh.vertices = taken<Vector3>(bytes, at);
  mesh.triangles = taken<std::array<int, 3>>(bytes, at);
  if (mesh.triangles.empty()) throw std::runtime_error("has no triangles; allowed: at least one");
  return mesh;
}

void make_solid(TriangleMesh& mesh) {
  const Vector3 extent = extent_of(mesh);
  const double seam = kSeam * extent.maxCoeff();
  if (count_open_edges(mesh) > 0 && seam > 0.0) weld(mesh, seam);
  if (const int open = count_open_edges(mesh)) {
    throw std::runtime_error("is not closed: " + std::to_string(open) +
                             " edges lack a neighbour or are turned against it, with vertices within " +
                             text::number(seam) +
                             " m joined; allowed for collision: a closed surface, or <!-- hull --> behind "
                             "the mesh for its convex hull");
  }
  const double volume = signed_volume(mesh);
  if (!(std::abs(volume) > 1e-9 * extent.maxCoeff() * extent.maxCoeff() * extent.maxCoeff())) {
    throw std::runtime_error("encloses no volume; allowed for collision: a closed surface around a volume");
  }
  if (volume < 0) {
    for (std::array<int, 3>& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  }
}

double signed_volume(const TriangleMesh& mesh) {
  double volume = 0;
  for (const std::array<int, 3>& triangle : mesh.triangles) {
    const Vector3 arm = mesh.vertices[triangle[0]] - mesh.vertices[0];
    volume += doubled_area(mesh, triangle).dot(arm) / 6;
  }
  return volume;
}

}  // namespace mrhi
