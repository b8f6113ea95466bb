#include "solid_mesh.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <sys/resource.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <new>
#include <optional>
#include <sstream>

#include "../text/files.h"
#include "../text/text.h"
#include "../text/untrusted_input.h"
#include "limits.h"
#include "mesh_file_system.h"

namespace mrhi {
namespace {

/// Gathers the triangles of a scene graph into one mesh.
class Collector {
 public:
  explicit Collector(const Vector3& scale) : scale_(scale) {}

  void add(const aiScene& scene, const aiNode& node, const aiMatrix4x4& parent) {
    const aiMatrix4x4 transform = parent * node.mTransformation;
    for (unsigned i = 0; i < node.mNumMeshes; ++i) add(*scene.mMeshes[node.mMeshes[i]], transform);
    for (unsigned i = 0; i < node.mNumChildren; ++i) add(scene, *node.mChildren[i], transform);
  }

  /// Adds a triangle, unless it is a point or a line. `mirrored`: its corners are listed clockwise.
  void add(const std::array<aiVector3D, 3>& corners, bool mirrored) {
    std::array<int, 3> triangle;
    for (std::size_t k = 0; k < 3; ++k) triangle[k] = vertex(corners[k]);
    if (mirrored != (scale_.prod() < 0)) std::swap(triangle[1], triangle[2]);
    if (!is_degenerate(triangle)) mesh_.triangles.push_back(triangle);
  }

  TriangleMesh take() { return std::move(mesh_); }

 private:
  void add(const aiMesh& part, const aiMatrix4x4& transform) {
    const bool mirrored = transform.Determinant() < 0;
    for (unsigned i = 0; i < part.mNumFaces; ++i) {
      const aiFace& face = part.mFaces[i];
      const auto corner = [&](unsigned k) { return transform * part.mVertices[face.mIndices[k]]; };
      if (face.mNumIndices == 3) add({{corner(0), corner(1), corner(2)}}, mirrored);
    }
  }

  int vertex(const aiVector3D& place) {
    // NaN compares as equivalent to every key of the map: it would be taken for a known vertex.
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

const std::vector<std::string> kFormats{".stl", ".obj", ".dae", ".ply", ".gltf", ".glb", ".off", ".3ds"};

std::string lower_extension(const std::string& file) {
  return text::in_lower_case(std::filesystem::path(file).extension().string());
}

constexpr std::size_t kMaxTriangles = 500'000;
constexpr ChildLimits kLimits{20, std::size_t(1) << 30, std::size_t(256) << 20};

/// Refuses a file of another format, one that is too large, and the pointer that git stores in place of a
/// large file that it has not fetched.
void check_file(const std::string& file) {
  const std::string extension = lower_extension(file), pointer = "version https://git-lfs";
  if (std::find(kFormats.begin(), kFormats.end(), extension) == kFormats.end())
    throw std::runtime_error("is of the format " + text::quoted(extension, 20) +
                             "; allowed: " + text::joined(kFormats));
  const std::string why = why_too_large(file);
  if (!why.empty()) throw std::runtime_error(why);
  if (file_text(file, pointer.size()) == pointer)
    throw std::runtime_error(
        "is a pointer of Git LFS; allowed: the file itself, that 'git lfs pull' fetches");
}

template <class Items>
void append(const Items& items, std::string& bytes) {
  const std::uint64_t count = items.size();
  bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
  bytes.append(reinterpret_cast<const char*>(items.data()), count * sizeof *items.data());
}

template <class Items>
void take(const std::string& bytes, std::size_t& at, Items& items) {
  std::uint64_t count = 0;
  std::memcpy(&count, &bytes.at(at), sizeof count);
  at += sizeof count;
  items.resize(count);
  const std::size_t size = count * sizeof *items.data();
  if (size > 0) std::memcpy(static_cast<void*>(items.data()), &bytes[at], size);
  at += size;
}

void append(const std::vector<std::string>& texts, std::string& bytes) {
  const std::uint64_t count = texts.size();
  bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
  for (const std::string& text : texts) append(text, bytes);
}

void take(const std::string& bytes, std::size_t& at, std::vector<std::string>& texts) {
  std::uint64_t count = 0;
  std::memcpy(&count, &bytes.at(at), sizeof count);
  at += sizeof count;
  texts.resize(count);
  for (std::string& text : texts) take(bytes, at, text);
}

void check_extent(const Vector3& extent, double part, const char* where) {
  if (body_limits::kSize.contains(part)) return;
  throw std::runtime_error("measures " + text::vector(extent) +
                           " m; allowed: " + body_limits::kSize.describe() + " m " + where +
                           (part > 1.0 ? "; scale=\"0.001 0.001 0.001\" makes metres of millimetres" : ""));
}

/// Checks all sizes of a collision mesh, like a box's. A visual mesh may be flat.
void check_sizes(const TriangleMesh& mesh, bool solid) {
  const Vector3 extent = box_around(mesh).sizes();
  check_extent(extent, extent.maxCoeff(), "along the longest axis");
  if (solid) check_extent(extent, extent.minCoeff(), "along each axis");
}

/// An STL in the form that assimp reads. Binary: without bytes behind the triangles, which take 50 bytes each
/// from byte 84 on. Text: in lower case, without leading blanks.
std::string plain_stl(const std::string& file) {
  std::string bytes = file_text(file, kMaxMeshBytes).value_or("");
  std::uint32_t count = 0;
  if (bytes.size() >= 84) std::memcpy(&count, &bytes[80], sizeof count);
  const std::uint64_t whole = 84 + std::uint64_t(50) * count;
  if (whole <= bytes.size()) {
    bytes.resize(whole);
    return bytes;
  }
  if (!bytes.empty() && bytes.find("solid") == std::string::npos && bytes.find("SOLID") == std::string::npos)
    throw std::runtime_error("cannot be read: it has " + std::to_string(bytes.size()) +
                             " bytes, its header stands for " + std::to_string(whole) +
                             "; allowed: a whole STL");
  bytes.erase(0, bytes.find_first_not_of(" \t\r\n"));
  return bytes.compare(0, 5, "SOLID") == 0 ? text::in_lower_case(bytes) : bytes;
}

/// A plain decimal number; nothing for "inf", "nan", and hexadecimal numbers, which other programs refuse.
std::optional<double> decimal(const std::string& word) {
  const bool plain = word.find_first_not_of("+-.0123456789eE") == std::string::npos;
  return plain ? text::to_number(word) : std::nullopt;
}

/// Reads a face with vertices of the form V/T/N. Adds its triangle, or both triangles of a convex quadrangle.
/// Returns false for any other face.
bool read_face(const std::vector<std::string>& words, const std::vector<aiVector3D>& vertices,
               std::vector<std::array<aiVector3D, 3>>& triangles) {
  std::vector<aiVector3D> face;
  for (const std::string& word : words) {
    const bool plain = word[0] != '/' && word.find_first_not_of("/0123456789") == std::string::npos;
    const std::size_t vertex = plain ? std::strtoul(word.c_str(), nullptr, 10) - 1 : vertices.size();
    if (vertex >= vertices.size()) return false;
    face.push_back(vertices[vertex]);
  }
  const auto normal = [&](int i, int j, int k) { return (face[j] - face[i]) ^ (face[k] - face[i]); };
  if (face.size() < 3 || face.size() > 4) return false;
  triangles.push_back({{face[0], face[1], face[2]}});
  if (face.size() == 3) return true;
  triangles.push_back({{face[0], face[2], face[3]}});
  return normal(0, 1, 2) * normal(0, 2, 3) > 0 && normal(1, 2, 3) * normal(1, 3, 0) > 0;
}

/// Reads a small OBJ of one group of such faces, the form of convex pieces. Returns false for any other OBJ.
/// Assimp clears 16 MB for each OBJ, which would take most of the time of loading 200 pieces.
bool read_piece(const std::string& file, Collector& collector) {
  constexpr std::size_t kMaxPieceBytes = 1u << 20;
  const std::string text = file_text(file, kMaxPieceBytes + 1).value_or("");
  if (text.size() > kMaxPieceBytes || text.find('\0') != std::string::npos) return false;
  std::vector<aiVector3D> vertices;
  std::vector<std::array<aiVector3D, 3>> triangles;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    const std::string kind = line.substr(0, line.find_first_of(" \t"));
    const std::vector<std::string> words = text::words(line.substr(kind.size()));
    if (kind == "v") {
      std::array<ai_real, 3> place{};
      if (words.size() != place.size()) return false;
      for (std::size_t i = 0; i < place.size(); ++i) {
        const std::optional<double> number = decimal(words[i]);
        if (!number) return false;
        place[i] = ai_real(*number);
      }
      vertices.emplace_back(place[0], place[1], place[2]);
    } else if (kind == "f") {
      if (!read_face(words, vertices, triangles)) return false;
    } else if (kind == "o" || kind == "g" || kind == "usemtl" || kind == "mtllib") {
      if (!triangles.empty() || line.back() == '\\') return false;
    } else if (!line.empty() && kind != "vn" && kind != "vt" && kind != "s" && kind[0] != '#') {
      return false;
    }
  }
  for (const auto& corners : triangles) collector.add(corners, false);
  return !triangles.empty();
}

/// Call within limits only: assimp has none, and a small file may expand to an endless scene.
LoadedMesh read_by_assimp(const MeshFile& source, Assimp::Importer& importer) {
  const std::string& file = source.file;
  Collector collector(source.scale);
  if (lower_extension(file) == ".obj" && read_piece(file, collector)) return {collector.take(), "", {}};
  auto* const files = new MeshFileSystem(file);
  importer.SetIOHandler(files);  // owns it
  const std::string stl = lower_extension(file) == ".stl" ? plain_stl(file) : "";
  const aiScene* scene =
      stl.empty() ? importer.ReadFile(file, aiProcess_Triangulate)
                  : importer.ReadFileFromMemory(stl.data(), stl.size(), aiProcess_Triangulate, "stl");
  std::string problem = importer.GetErrorString();
  if (problem.find("bad_alloc") != std::string::npos) throw std::bad_alloc();
  const bool is_read = scene != nullptr && scene->mRootNode != nullptr;
  if (!is_read && !files->refusal().empty()) throw std::runtime_error(files->refusal());
  if (!is_read) {
    // Before 5.1 assimp says nothing of a glTF's missing file.
    if (problem.empty() && !files->missing().empty()) problem = files->missing() + " is not there";
    throw std::runtime_error("cannot be read: " + text::one_line(problem, 120) +
                             "; allowed: a whole STL, OBJ, DAE, PLY or glTF file");
  }
  collector.add(*scene, *scene->mRootNode, aiMatrix4x4());
  return {collector.take(), "", {files->opened().begin(), files->opened().end()}};
}

/// Returns what `work` does; its problem in place of an exception.
template <class Work>
LoadedMesh without_exceptions(const Work& work) {
  LoadedMesh refused;
  try {
    return work();
  } catch (const std::bad_alloc&) {
    refused.problem = "takes more memory than is allowed";
  } catch (const NoVolume& error) {
    refused.problem = error.what(), refused.is_flat = true;
  } catch (const std::exception& error) {
    refused.problem = error.what();
  }
  return refused;
}

LoadedMesh read_surface(const MeshFile& source, Assimp::Importer& importer) {
  check_file(source.file);
  LoadedMesh loaded = read_by_assimp(source, importer);
  const std::size_t count = loaded.mesh.triangles.size();
  if (count == 0) throw std::runtime_error("has no triangles; allowed: at least one");
  if (count > kMaxTriangles)
    throw std::runtime_error("has " + std::to_string(count) + " triangles; allowed: at most " +
                             std::to_string(kMaxTriangles));
  check_sizes(loaded.mesh, false);
  return loaded;
}

LoadedMesh used_as(MeshUse use, LoadedMesh loaded) {
  if (use == MeshUse::surface || !loaded.problem.empty()) return loaded;
  if (use == MeshUse::hull) loaded.mesh = convex_hull(loaded.mesh);
  loaded.assumed = make_solid(loaded.mesh);
  check_sizes(loaded.mesh, true);
  return loaded;
}

/// Reads files in the child process, each once for all its uses. Refuses those beyond the budget.
class Reader {
 public:
  explicit Reader(std::size_t max_triangles) : max_triangles_(max_triangles) {
    importer_.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  }

  const LoadedMesh& surface_of(const MeshFile& file) {
    const auto [found, is_new] = surfaces_.emplace(file.file + text::exact(file.scale), LoadedMesh{});
    if (!is_new) return found->second;
    found->second = without_exceptions([&] {
      LoadedMesh loaded = triangles_ > max_triangles_ ? LoadedMesh{} : read_surface(file, importer_);
      triangles_ += loaded.mesh.triangles.size();
      if (triangles_ <= max_triangles_) return loaded;
      throw std::runtime_error("is one too many: the scene's meshes have over " +
                               std::to_string(max_triangles_) + " triangles; allowed: at most that in all");
    });
    return found->second;
  }

  std::size_t triangles() const { return triangles_; }

 private:
  const std::size_t max_triangles_;
  std::size_t triangles_ = 0;
  Assimp::Importer importer_;  // one for all files: creating it takes longer than reading a small one
  std::map<std::string, LoadedMesh> surfaces_;
};

/// The triangles that the files have in all, and the meshes.
std::string read_all(const std::vector<MeshFile>& files, const MeshBudget& budget) {
  Reader reader(budget.triangles);
  for (const MeshFile& file : files) reader.surface_of(file);  // a sum that is too large is found at once
  std::string all;
  append(std::to_string(reader.triangles()), all);
  for (const MeshFile& file : files) {
    const LoadedMesh loaded = without_exceptions([&] { return used_as(file.use, reader.surface_of(file)); });
    append(loaded.problem, all);
    append(loaded.files, all);
    append(loaded.assumed, all);
    append(std::string(loaded.is_flat ? 1 : 0, 'f'), all);
    append(loaded.mesh.vertices, all);
    append(loaded.mesh.triangles, all);
    append(loaded.mesh.parts, all);
  }
  return all;
}

double processor_time_of_children() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  const auto seconds = [](const timeval& of) {
    return static_cast<double>(of.tv_sec) + 1e-6 * static_cast<double>(of.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// Subtracts the processor time of the children that end in its life [s].
class Spending {
 public:
  explicit Spending(double& seconds) : seconds_(seconds) {}
  Spending(const Spending&) = delete;
  ~Spending() { seconds_ -= processor_time_of_children() - begin_; }

 private:
  double& seconds_;
  const double begin_ = processor_time_of_children();
};

std::vector<LoadedMesh> read_in_child(const std::vector<MeshFile>& files, MeshBudget& budget,
                                      const std::function<bool()>& is_cancelled) {
  ChildLimits limits = kLimits;
  limits.seconds = std::min(limits.seconds, budget.seconds);
  if (limits.seconds <= 0.0)
    throw std::runtime_error("is one too many: the scene's meshes take more time than is allowed in all");
  const Spending spending(budget.seconds);
  const std::string bytes = run_in_child(
      limits, [&] { return read_all(files, budget); }, is_cancelled);
  std::size_t at = 0;
  std::string triangles, flat;
  take(bytes, at, triangles);
  budget.triangles -= std::min<std::size_t>(budget.triangles, std::strtoull(triangles.c_str(), nullptr, 10));
  std::vector<LoadedMesh> meshes(files.size());
  for (LoadedMesh& mesh : meshes) {
    take(bytes, at, mesh.problem);
    take(bytes, at, mesh.files);
    take(bytes, at, mesh.assumed);
    take(bytes, at, flat);
    mesh.is_flat = !flat.empty();
    take(bytes, at, mesh.mesh.vertices);
    take(bytes, at, mesh.mesh.triangles);
    take(bytes, at, mesh.mesh.parts);
  }
  return meshes;
}

}  // namespace

/// If the files exceed the limits together, each is read in a process of its own, to find the one at fault.
std::vector<LoadedMesh> load_meshes(const std::vector<MeshFile>& files, MeshBudget& budget,
                                    const std::function<bool()>& is_cancelled) {
  if (files.empty()) return {};
  try {
    return read_in_child(files, budget, is_cancelled);
  } catch (const std::runtime_error& error) {
    if (is_cancelled && is_cancelled()) throw;
    if (files.size() == 1) return {{{}, error.what(), {}}};
  }
  std::vector<LoadedMesh> meshes;
  meshes.reserve(files.size());
  for (const MeshFile& file : files) meshes.push_back(load_meshes({file}, budget, is_cancelled).front());
  return meshes;
}

}  // namespace mrhi
