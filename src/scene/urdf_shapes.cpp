#include <cctype>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <locale>
#include <sstream>
#include <stdexcept>

#include "../text/files.h"
#include "../text/text.h"
#include "limits.h"
#include "mr_hand_interaction/scene/shape.h"
#include "shape_kinds.h"
#include "solid_mesh.h"
#include "urdf.h"

namespace mrhi {
namespace {

using Sizes = std::vector<double>;

const std::string kPrefix = ":shape:";

Sizes sizes(const Box& box) {
  const Vector3 size = 2.0 * box.half_extents;
  return {size.x(), size.y(), size.z()};
}
Sizes sizes(const Sphere& sphere) {
  return {sphere.radius};
}
template <typename Long>
Sizes sizes(const Long& shape) {
  return {shape.radius, 2.0 * shape.half_length};
}

template <typename Kind>
std::optional<Sizes> sizes_if(const Shape& shape) {
  const Kind* const one = std::get_if<Kind>(&shape);
  return one == nullptr ? std::nullopt : std::optional<Sizes>(sizes(*one));
}

/// The number in a word, also if it is not a valid size; NaN if there is none.
double size_in(const std::string& word) {
  std::istringstream stream(word);
  stream.imbue(std::locale::classic());
  double size = 0.0;
  if (stream >> size && stream.eof()) return size;
  const std::optional<double> other = text::to_number(word);  // infinity, or too large for a double
  return other && std::isinf(*other) ? *other : std::numeric_limits<double>::quiet_NaN();
}

template <typename Long>
Shape make_long(const Sizes& s) {
  return Long{s[0], 0.5 * s[1]};
}

namespace fs = std::filesystem;

bool begins_with(const std::string& text, const std::string& prefix) {
  return text.compare(0, prefix.size(), prefix) == 0;
}

/// A kind and its sizes, read from the result of as_filename().
struct SizedShape {
  const ShapeKind* kind;
  Sizes size;
};

std::optional<SizedShape> from_filename(const std::string& filename) {
  if (!begins_with(filename, kPrefix)) return std::nullopt;
  std::istringstream words(filename.substr(kPrefix.size()));
  words.imbue(std::locale::classic());
  std::string name;
  words >> name;
  SizedShape shape{find_shape_kind(name), {}};
  if (shape.kind == nullptr) return std::nullopt;
  for (std::string word; words >> word;) shape.size.push_back(size_in(word));
  shape.size.resize(shape.kind->sizes.size(), 0.0);
  return shape;
}

std::string percent_decoded(const std::string& uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    int code = 0;
    if (uri[i] == '%' && i + 2 < uri.size() && std::isxdigit(static_cast<unsigned char>(uri[i + 1])) != 0)
      code = static_cast<int>(std::strtol(uri.substr(i + 1, 2).c_str(), nullptr, 16));
    text += code < ' ' ? uri[i] : static_cast<char>(code);
    if (code >= ' ') i += 2;
  }
  return text;
}

/// True if the folder has a package.xml with that name.
bool is_package(const fs::path& folder, const std::string& name) {
  constexpr std::size_t kMaxBytes = 100000;
  const std::string text = file_text((folder / "package.xml").string(), kMaxBytes).value_or("");
  return text.find("<name>" + name + "</name>") != std::string::npos;
}

/// Finds the file NAME/PATH of a package in the folders above, as other simulators do: below one of them, or
/// in one that has the package's name or a package.xml with that name.
std::string find_above(const fs::path& folder, const std::string& in_package) {
  const std::string name = in_package.substr(0, in_package.find('/'));
  std::error_code error;
  fs::path above = fs::absolute(folder, error).lexically_normal();
  for (int level = 0; level < 32 && !error; ++level, above = above.parent_path()) {
    if (is_file(above / in_package)) return (above / in_package).string();
    const fs::path in_above = above / in_package.substr(std::min(name.size() + 1, in_package.size()));
    if ((above.filename() == name || is_package(above, name)) && is_file(in_above)) return in_above.string();
    if (above == above.root_path()) break;
  }
  return "";
}

/// A file below a folder whose path differs from `path` in case only; empty if there is none.
std::string find_ignoring_case(fs::path folder, const std::string& path) {
  for (const fs::path& part : fs::path(path).relative_path()) {
    std::error_code ignored;
    if (fs::exists(folder / part, ignored)) {
      folder /= part;
      continue;
    }
    std::string found;  // the alphabetically first
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
      const std::string name = entry.path().filename().string();
      if (text::in_lower_case(name) == text::in_lower_case(part.string()) && (found.empty() || name < found))
        found = name;
    }
    if (found.empty()) return "";
    folder /= found;
  }
  return is_file(folder) ? folder.string() : "";
}

}  // namespace

const std::vector<ShapeKind>& shape_kinds() {
  static const std::vector<ShapeKind> kinds{
      {"box",
       {"x", "y", "z"},
       [](const Sizes& s) -> Shape { return Box{0.5 * Vector3(s[0], s[1], s[2])}; },
       sizes_if<Box>},
      {"sphere", {"radius"}, [](const Sizes& s) -> Shape { return Sphere{s[0]}; }, sizes_if<Sphere>},
      {"cylinder", {"radius", "length"}, make_long<Cylinder>, sizes_if<Cylinder>},
      {"capsule", {"radius", "length"}, make_long<Pill>, sizes_if<Pill>},
  };
  return kinds;
}

const ShapeKind* find_shape_kind(const std::string& name) {
  return text::find_named(shape_kinds(), name);
}

std::string shape_kind_names() {
  return text::joined(text::names_of(shape_kinds()));
}

std::string ShapeKind::describe(const std::vector<double>& size) const {
  if (size.size() == 3) return name + " size " + text::vector(Vector3(size[0], size[1], size[2]));
  std::string all = name;
  for (std::size_t i = 0; i < size.size(); ++i)
    all += (i == 0 ? " " : " and ") + sizes[i] + " " + text::number(size[i]);
  return all;
}

std::string as_filename(const ShapeKind& kind, const std::vector<double>& size) {
  std::string name = kPrefix + kind.name;
  for (const double part : size) name += " " + text::exact(part);
  return name;
}

double bounding_radius(const Shape& shape) {
  return std::visit([](const auto& any) { return any.bounding_radius(); }, shape);
}

struct ShapeReader::Named {
  std::string uri, file;  ///< file: empty if it is not found
  Vector3 scale;
  bool hull;
  MeshUse use(bool solid) const { return !solid ? MeshUse::surface : hull ? MeshUse::hull : MeshUse::solid; }
  std::string key(MeshUse use) const {
    return file + " " + text::vector(scale) + " " + std::to_string(static_cast<int>(use));
  }
};

ShapeReader::Named ShapeReader::named(const urdf::Mesh& mesh) const {
  const bool hull = begins_with(mesh.filename, kHullPrefix);
  const std::string uri = hull ? mesh.filename.substr(std::string(kHullPrefix).size()) : mesh.filename;
  return {uri, find_file(uri), {mesh.scale.x, mesh.scale.y, mesh.scale.z}, hull};
}

/// Finds a mesh file by its name as written, with backslashes as slashes, percent-decoded, or ignoring case.
std::string ShapeReader::find_file(const std::string& uri) const {
  const auto replaced = options_.mesh_files.find(uri);
  if (replaced != options_.mesh_files.end()) return replaced->second;
  std::string path = uri;
  std::string file = find_path(path);
  if (file.empty()) std::replace(path.begin(), path.end(), '\\', '/'), file = find_path(path);
  if (file.empty()) path = percent_decoded(path), file = find_path(path);
  if (!file.empty()) return file;
  file = find_ignoring_case(folder_, path);
  if (!file.empty()) warnings_.add("files are found by names in another case", text::quoted(uri, 200));
  return file;
}

std::string ShapeReader::find_path(const std::string& uri) const {
  for (const char* scheme : {"package://", "model://"}) {
    if (!begins_with(uri, scheme)) continue;
    const std::string file = options_.resolve_package_uri ? options_.resolve_package_uri(uri) : "";
    return is_file(file) ? file : find_above(folder_, uri.substr(std::string(scheme).size()));
  }
  std::string path = begins_with(uri, "file://") ? uri.substr(7) : uri;
  if (begins_with(uri, "file://localhost/")) path.erase(0, 9);
  return is_file(fs::path(folder_) / path) ? (fs::path(folder_) / path).string() : "";
}

void ShapeReader::prepare(const std::vector<LinkedBody>& bodies) {
  std::vector<MeshFile> wanted;
  std::vector<std::string> keys;
  const auto want = [&](const urdf::GeometrySharedPtr& geometry, bool solid) {
    if (!geometry || geometry->type != urdf::Geometry::MESH) return;
    const auto& mesh = static_cast<const urdf::Mesh&>(*geometry);
    if (from_filename(mesh.filename)) return;
    const Named name = named(mesh);
    const MeshUse use = name.use(solid);
    if (name.file.empty() || !loaded_.emplace(name.key(use), LoadedMesh{}).second) return;
    wanted.push_back({name.file, name.scale, use});
    keys.push_back(name.key(use));
  };
  for (const LinkedBody& body : bodies) {
    const bool collides = std::any_of(body.parts.begin(), body.parts.end(), [](const LinkPart& part) {
      return !part.link->collision_array.empty();
    });
    for (const LinkPart& part : body.parts) {
      for (const auto& collision : part.link->collision_array) want(collision->geometry, true);
      for (const auto& visual : part.link->visual_array) {
        want(visual->geometry, false);
        if (!body.fixed && !collides) want(visual->geometry, true);
      }
    }
  }
  std::vector<LoadedMesh> meshes = load(wanted);
  for (std::size_t i = 0; i < meshes.size(); ++i) loaded_[keys[i]] = std::move(meshes[i]);
}

std::vector<LoadedMesh> ShapeReader::load(const std::vector<MeshFile>& files) {
  return rethrown<SceneError, std::runtime_error>(
      source_ + ": ", [&] { return load_meshes(files, budget_, options_.is_cancelled); });
}

std::optional<Shape> ShapeReader::read(const urdf::Geometry& geometry, const std::string& element,
                                       bool solid) {
  switch (geometry.type) {
    case urdf::Geometry::SPHERE:
      return make("sphere", {static_cast<const urdf::Sphere&>(geometry).radius}, element);
    case urdf::Geometry::BOX: {
      const urdf::Vector3& size = static_cast<const urdf::Box&>(geometry).dim;
      return make("box", {size.x, size.y, size.z}, element);
    }
    case urdf::Geometry::CYLINDER: {
      const auto& cylinder = static_cast<const urdf::Cylinder&>(geometry);
      return make("cylinder", {cylinder.radius, cylinder.length}, element);
    }
    default: {
      const auto& mesh = static_cast<const urdf::Mesh&>(geometry);
      if (const auto shape = from_filename(mesh.filename))
        return make(shape->kind->name, shape->size, element);
      return read_mesh(mesh, element, solid);
    }
  }
}

std::optional<Shape> ShapeReader::make(const std::string& name, const std::vector<double>& size,
                                       const std::string& element) {
  const Range& range = body_limits::kSize;
  const ShapeKind& kind = *find_shape_kind(name);
  if (std::all_of(size.begin(), size.end(), [&](double s) { return s >= 0.0 && s < range.min; })) {
    warnings_.add("shapes smaller than " + text::number(range.min) + " m are left out", element);
    return std::nullopt;
  }
  for (const double s : size) {
    if (!range.contains(s))
      fail(element, kind.describe(size) + " m is not allowed; allowed: " + range.describe() + " m");
  }
  return kind.make(size);
}

/// A visual mesh may be missing: the collision shape is then drawn instead.
std::optional<Shape> ShapeReader::read_mesh(const urdf::Mesh& mesh, const std::string& element, bool solid) {
  const Named name = named(mesh);
  const std::string what = "mesh " + text::quoted(name.uri, 200) + " ";
  if (!name.scale.allFinite() || (name.scale.array() == 0).any())
    fail(element, "mesh scale " + text::vector(name.scale) +
                      " is not allowed; allowed: three numbers, none of them 0");
  try {
    if (name.file.empty())
      throw std::runtime_error(begins_with(name.uri, "package://")
                                   ? "not found; allowed: a file of a package that is on the ROS path, or "
                                     "that is a folder above the URDF"
                                   : "not found in '" + (folder_.empty() ? "." : folder_) +
                                         "'; allowed: package://, file://, or a path from the URDF's folder");
    const auto used = triangles_of(name, solid, element);
    const bool is_uri = name.uri.find("://") != std::string::npos;
    return Mesh{used,
                is_uri && !begins_with(name.uri, "model")
                    ? name.uri
                    : "file://" + fs::absolute(name.file).lexically_normal().string(),
                name.scale};
  } catch (const NoVolume& error) {
    warnings_.add("flat sheets do not touch and are left out", element + " " + what + error.what());
  } catch (const std::runtime_error& error) {
    if (solid) fail(element, what + error.what());
    warnings_.add("visuals that cannot be read are left out", element + " " + what + error.what());
  }
  return std::nullopt;
}

std::shared_ptr<const TriangleMesh> ShapeReader::triangles_of(const Named& mesh, bool solid,
                                                              const std::string& element) {
  const MeshUse use = mesh.use(solid);
  const auto [found, is_new] = loaded_.emplace(mesh.key(use), LoadedMesh{});
  LoadedMesh& loaded = found->second;
  // prepare() has not loaded a visual that takes the place of flat collisions
  if (is_new) loaded = load({{mesh.file, mesh.scale, use}}).front();
  if (loaded.is_flat) throw NoVolume(loaded.problem);
  if (!loaded.problem.empty()) throw std::runtime_error(loaded.problem);
  const auto note = [&](const std::string& name, const std::string& path) {
    if (text::find_named(files_, name) == nullptr) files_.push_back({name, path});
  };
  note(mesh.uri, mesh.file);
  for (const std::string& file : loaded.files)
    note((fs::path(mesh.uri).parent_path() / file).string(),
         (fs::path(mesh.file).parent_path() / file).string());
  auto& used = meshes_[mesh.key(use)];
  if (used) return used;
  for (const std::string& assumed : loaded.assumed)
    warnings_.add("a mesh " + assumed, element + " " + text::quoted(mesh.uri, 100));
  return used = std::make_shared<const TriangleMesh>(std::move(loaded.mesh));
}

void ShapeReader::fail(const std::string& element, const std::string& what) const {
  throw SceneError(source_ + ": " + element + ": " + text::one_line(what));
}

}  // namespace mrhi
