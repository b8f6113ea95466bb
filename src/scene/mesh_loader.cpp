#include "mesh_loader.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <filesystem>
#include <map>
#include <stdexcept>

#include "text.h"

namespace mrhi {
namespace {

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
    const auto inserted = known_.emplace(std::array<ai_real, 3>{{place.x, place.y, place.z}},
                                         static_cast<int>(mesh_.vertices.size()));
    if (inserted.second) mesh_.vertices.push_back(scale_.cwiseProduct(Vector3(place.x, place.y, place.z)));
    return inserted.first->second;
  }

  Vector3 scale_;
  TriangleMesh mesh_;
  std::map<std::array<ai_real, 3>, int> known_;
};

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

}  // namespace

TriangleMesh load_mesh(const std::string& file, const Vector3& scale) {
  check_format(file);
  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFile(file, aiProcess_Triangulate);
  if (!scene || !scene->mRootNode) {
    throw std::runtime_error("cannot be read: " + text::one_line(importer.GetErrorString(), 120) +
                             "; allowed: a whole STL, OBJ or DAE file");
  }
  Collector collector(scale);
  collector.add(*scene, *scene->mRootNode, aiMatrix4x4());
  TriangleMesh mesh = collector.take();
  if (mesh.triangles.empty()) throw std::runtime_error("has no triangles; allowed: at least one");
  for (const Vector3& vertex : mesh.vertices) {
    if (!vertex.allFinite())
      throw std::runtime_error("has a vertex that is not finite; allowed: finite numbers");
  }
  return mesh;
}

void make_solid(TriangleMesh& mesh) {
  if (const int open = count_open_edges(mesh)) {
    throw std::runtime_error(
        "is not closed: " + std::to_string(open) +
        " edges lack a neighbour or are turned against it; allowed for collision: a closed "
        "surface");
  }
  const double volume = signed_volume(mesh);
  Vector3 extent = Vector3::Zero();
  for (const Vector3& vertex : mesh.vertices)
    extent = extent.cwiseMax((vertex - mesh.vertices[0]).cwiseAbs());
  if (!(std::abs(volume) > 1e-9 * extent.maxCoeff() * extent.maxCoeff() * extent.maxCoeff())) {
    throw std::runtime_error("encloses no volume; allowed for collision: a closed surface around a volume");
  }
  if (volume < 0) {
    for (std::array<int, 3>& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  }
  const double least = 1e-12 * extent.squaredNorm();
  mesh.triangles.erase(std::remove_if(mesh.triangles.begin(), mesh.triangles.end(),
                                      [&](const auto& t) { return doubled_area(mesh, t).norm() <= least; }),
                       mesh.triangles.end());
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
