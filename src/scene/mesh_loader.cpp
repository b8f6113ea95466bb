#include "solid_mesh.h"

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

#include "../text/files.h"
#include "../text/text.h"
#include "../text/untrusted_input.h"

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

const char* const kFormats[] = {".stl", ".obj", ".dae", ".ply", ".gltf", ".glb", ".off", ".3ds"};

std::string lower_extension(const std::string& file) {
  std::string extension = std::filesystem::path(file).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

void check_format(const std::string& file) {
  const std::string extension = lower_extension(file);
  std::string all;
  for (const char* known : kFormats) {
    if (extension == known) return;
    all += (all.empty() ? "" : ", ") + std::string(known);
  }
  throw std::runtime_error("is of the format '" + text::one_line(extension, 20) + "'; allowed: " + all);
}

/// What stands for a large file where git has not fetched it.
void check_fetched(const std::string& file) {
  const std::string pointer = "version https://git-lfs";
  if (file_text(file, pointer.size()) == pointer)
    throw std::runtime_error(
        "is a pointer of Git LFS; allowed: the file itself, that 'git lfs pull' fetches");
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

/// An STL as assimp knows it: without bytes behind its triangles, of which each takes 50 and the first begins
/// at 84; and if it is text, in lower case and without blanks before it.
std::string plain_stl(const std::string& file) {
  std::string bytes = file_text(file, kMostBytes).value_or("");
  std::uint32_t count = 0;
  if (bytes.size() < 84) return bytes;
  std::memcpy(&count, &bytes[80], sizeof count);
  const std::uint64_t whole = 84 + std::uint64_t(50) * count;
  if (whole <= bytes.size()) {
    bytes.resize(whole);
    return bytes;
  }
  bytes.erase(0, bytes.find_first_not_of(" \t\r\n"));
  if (bytes.compare(0, 5, "SOLID") == 0) {
    for (char& c : bytes) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return bytes;
}

/// Assimp reads what is given to it without any limit, and a small file may stand for an endless scene.
TriangleMesh read_by_assimp(const std::string& file, const Vector3& scale, Assimp::Importer& importer) {
  const std::string stl = lower_extension(file) == ".stl" ? plain_stl(file) : "";
  const aiScene* scene =
      stl.empty() ? importer.ReadFile(file, aiProcess_Triangulate)
                  : importer.ReadFileFromMemory(stl.data(), stl.size(), aiProcess_Triangulate, "stl");
  const std::string problem = importer.GetErrorString();
  if (problem.find("bad_alloc") != std::string::npos) throw std::bad_alloc();
  if (!scene || !scene->mRootNode) {
    throw std::runtime_error("cannot be read: " + text::one_line(problem, 120) +
                             "; allowed: a whole STL, OBJ, DAE, PLY or glTF file");
  }
  Collector collector(scale);
  collector.add(*scene, *scene->mRootNode, aiMatrix4x4());
  return collector.take();
}

LoadedMesh read(const MeshFile& source, Assimp::Importer& importer) {
  LoadedMesh loaded;
  try {
    check_format(source.file);
    check_size(source.file);
    check_fetched(source.file);
    loaded.mesh = read_by_assimp(source.file, source.scale, importer);
    const std::size_t count = loaded.mesh.triangles.size();
    if (count == 0) throw std::runtime_error("has no triangles; allowed: at least one");
    if (count > kMostTriangles)
      throw std::runtime_error("has " + std::to_string(count) + " triangles; allowed: at most " +
                               std::to_string(kMostTriangles));
  } catch (const std::bad_alloc&) {
    loaded = {{}, "takes more memory than is allowed"};
  } catch (const std::exception& error) {
    loaded = {{}, error.what()};
  }
  return loaded;
}

std::vector<LoadedMesh> read_in_child(const std::vector<MeshFile>& files) {
  const std::string bytes = run_in_child(kLimits, [&] {
    std::string all;
    Assimp::Importer importer;  // one for all: making it takes longer than a small file
    importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
    for (const MeshFile& file : files) {
      const LoadedMesh loaded = read(file, importer);
      append(std::vector<char>(loaded.problem.begin(), loaded.problem.end()), all);
      append(loaded.problem.empty() ? loaded.mesh.vertices : std::vector<Vector3>{}, all);
      append(loaded.problem.empty() ? loaded.mesh.triangles : std::vector<std::array<int, 3>>{}, all);
    }
    return all;
  });
  std::vector<LoadedMesh> meshes(files.size());
  std::size_t at = 0;
  for (LoadedMesh& mesh : meshes) {
    const std::vector<char> problem = taken<char>(bytes, at);
    mesh.problem.assign(problem.begin(), problem.end());
    mesh.mesh.vertices = taken<Vector3>(bytes, at);
    mesh.mesh.triangles = taken<std::array<int, 3>>(bytes, at);
  }
  return meshes;
}

}  // namespace

/// What is too much for one child process is read one by one, so that it is known which file is to blame.
std::vector<LoadedMesh> load_meshes(const std::vector<MeshFile>& files) {
  if (files.empty()) return {};
  try {
    return read_in_child(files);
  } catch (const std::runtime_error& error) {
    if (files.size() == 1) return {{{}, error.what()}};
  }
  std::vector<LoadedMesh> meshes;
  meshes.reserve(files.size());
  for (const MeshFile& file : files) meshes.push_back(load_meshes({file}).front());
  return meshes;
}

}  // namespace mrhi
