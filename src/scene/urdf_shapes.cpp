#include "urdf.h"

#include <Eigen/Geometry>
#include <filesystem>
#include <stdexcept>

#include "../text/text.h"
#include "limits.h"
#include "mesh_loader.h"
#include "shape_kinds.h"

namespace mrhi {
namespace {

namespace fs = std::filesystem;

Vector3 to_vector(const urdf::Vector3& v) {
  return {v.x, v.y, v.z};
}

bool begins_with(const std::string& text, const std::string& prefix) {
  return text.compare(0, prefix.size(), prefix) == 0;
}

void check_extent(const Vector3& extent, double part, const char* where) {
  if (body_limits::kSize.contains(part)) return;
  throw std::runtime_error("measures " + text::vector(extent) +
                           " m; allowed: " + body_limits::kSize.describe() + " m " + where);
}

/// Of a thing that collides each size, as a box's; a picture may be flat.
void check_sizes(const TriangleMesh& mesh, bool solid) {
  Eigen::AlignedBox3d box;
  for (const Vector3& vertex : mesh.vertices) box.extend(vertex);
  const Vector3 extent = box.sizes();
  check_extent(extent, extent.maxCoeff(), "along the longest axis");
  if (solid) check_extent(extent, extent.minCoeff(), "along each axis");
}

}  // namespace

Shape ShapeReader::read(const urdf::Geometry& geometry, const std::string& element, bool solid) {
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
      if (const auto given = from_filename(mesh.filename))
        return make(given->kind->name, given->size, element);
      return read_mesh(mesh, element, solid);
    }
  }
}

Shape ShapeReader::make(const std::string& name, const std::vector<double>& size,
                        const std::string& element) const {
  const Range& range = body_limits::kSize;
  const ShapeKind& kind = *find_shape_kind(name);
  for (const double s : size) {
    if (!range.contains(s))
      fail(element, kind.describe(size) + " m is not allowed; allowed: " + range.describe() + " m");
  }
  return kind.make(size);
}

Mesh ShapeReader::read_mesh(const urdf::Mesh& mesh, const std::string& element, bool solid) {
  const Vector3 scale = to_vector(mesh.scale);
  if (!scale.allFinite() || (scale.array() == 0).any()) {
    fail(element,
         "mesh scale " + text::vector(scale) + " is not allowed; allowed: three numbers, none of them 0");
  }
  const bool hull = solid && is_hull(mesh.filename);
  const std::string uri = without_hull(mesh.filename);
  const std::string file = mesh_file(uri, element);
  const std::string key = file + (hull ? " hull " : solid ? " solid " : " ") + text::vector(scale);
  if (!meshes_.count(key)) {
    try {
      TriangleMesh triangles = load_mesh(file, scale);
      check_sizes(triangles, false);
      if (hull) triangles = convex_hull(triangles);
      if (solid) make_solid(triangles);
      check_sizes(triangles, solid);
      meshes_[key] = std::make_shared<const TriangleMesh>(std::move(triangles));
    } catch (const std::runtime_error& error) {
      fail(element, "mesh '" + uri + "' " + error.what());
    }
  }
  const bool is_uri = uri.find("://") != std::string::npos;
  return {meshes_[key], is_uri ? uri : "file://" + fs::absolute(file).lexically_normal().string(), scale};
}

std::string ShapeReader::mesh_file(const std::string& uri, const std::string& element) const {
  fs::path file = fs::path(urdf_file_).parent_path() / uri;
  if (begins_with(uri, "file://")) file = uri.substr(7);
  if (begins_with(uri, "package://")) {
    file = options_.resolve_package_uri ? options_.resolve_package_uri(uri) : std::string();
    if (file.empty())
      fail(element, "mesh '" + uri + "': package not found; allowed: a package on the ROS path");
  }
  std::error_code ignored;
  if (fs::is_regular_file(file, ignored)) return file.string();
  fail(element, "mesh '" + uri + "' not found at '" + file.string() +
                    "'; allowed: package://, file://, or a path from the URDF's folder");
}

void ShapeReader::fail(const std::string& element, const std::string& what) const {
  throw SceneError(urdf_file_ + ": " + element + ": " + text::one_line(what));
}

}  // namespace mrhi
