#include "mr_hand_interaction/scene/object_request.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "../text/files.h"
#include "../text/text.h"
#include "../text/untrusted_input.h"
#include "limits.h"
#include "shape_kinds.h"
#include "urdf.h"

namespace mrhi {
namespace {

const std::string kSource = "spawn";  // in place of a file's name

const ShapeKind& kind_of(const std::string& name) {
  if (const ShapeKind* kind = find_shape_kind(name)) return *kind;
  throw SceneError(kSource + ": shape " + text::quoted(name) +
                   " is not known; allowed: " + shape_kind_names() + ", or a URDF in its place");
}

/// XML of a link with that shape. It has no inertia, so the loader computes the shape's.
LinkedBody placed_shape(const ObjectRequest& request) {
  const ShapeKind& kind = kind_of(request.shape);
  if (request.size.size() != kind.sizes.size()) {
    throw SceneError(kSource + ": size of a " + kind.name + " has " + std::to_string(request.size.size()) +
                     " numbers; allowed: " + std::to_string(kind.sizes.size()) + " (" +
                     text::joined(kind.sizes) + ") [m]");
  }
  const Range& range = body_limits::kSize;
  if (!std::all_of(request.size.begin(), request.size.end(), [&](double s) { return range.contains(s); }))
    throw SceneError(kSource + ": " + kind.describe(request.size) +
                     " m is not allowed; allowed: " + range.describe() + " m");
  auto link = std::make_shared<urdf::Link>();
  auto collision = std::make_shared<urdf::Collision>();
  auto geometry = std::make_shared<urdf::Mesh>();
  geometry->filename = as_filename(kind, request.size);
  collision->geometry = geometry;
  link->collision_array = {collision};
  link->inertial = std::make_shared<urdf::Inertial>();
  link->inertial->mass = request.mass;
  link->name = request.name;
  return {{{link, Pose{}}}, request.mass == 0.0, request.pose};
}

LinkedBody placed_urdf(const ObjectRequest& request, UrdfDocument& document) {
  document = parse_urdf(kSource, request.urdf);
  LinkedBody placed = only_body(kSource, document);
  placed.in_world = request.pose;
  if (request.name.empty()) return placed;
  auto renamed = std::make_shared<urdf::Link>(placed.link());
  const auto friction = document.friction.find(renamed->name);
  if (friction != document.friction.end()) document.friction[request.name] = friction->second;
  renamed->name = request.name;
  placed.parts.front().link = renamed;
  return placed;
}

void check_motion(const ObjectRequest& request) {
  const Pose& pose = request.pose;
  const bool unit = std::abs(pose.orientation.norm() - 1.0) < 0.01;  // not for NaN either
  const auto refuse = [](const std::string& what, const Vector3& value) {
    throw SceneError(kSource + ": " + what + text::vector(value) +
                     " is not allowed; allowed: finite numbers");
  };
  if (!pose.position.allFinite()) refuse("position ", pose.position);
  if (!unit)
    throw SceneError(kSource + ": orientation " + text::quaternion(pose.orientation) +
                     " is not allowed; allowed: a unit quaternion [x, y, z, w]");
  if (!request.twist.linear.allFinite()) refuse("linear velocity ", request.twist.linear);
  if (!request.twist.angular.allFinite()) refuse("angular velocity ", request.twist.angular);
}

Scene scene_of_body(const ObjectRequest& request, const SceneOptions& options) {
  check_motion(request);
  UrdfDocument document;
  LinkedBody placed = request.urdf.empty() ? placed_shape(request) : placed_urdf(request, document);
  placed.in_world.orientation.normalize();
  Scene scene;
  read_body(kSource, request.folder, document, placed, options, scene);
  Body& body = scene.bodies.front();
  body.start_twist = request.twist;
  if (request.rgba) {
    check_color(kSource, *request.rgba);
    for (Visual& visual : body.visuals) visual.rgba = *request.rgba;
  }
  if (!request.material.empty()) apply_material_yaml(kSource + ": material", request.material, body);
  return scene;
}

void put_before(const std::string& name, Scene& scene) {
  if (name.empty()) return;
  const auto rename = [&](std::string& own) {
    own = name + "_" + own;
    if (!is_name(own))
      throw SceneError(kSource + ": the name " + text::quoted(own, 80) +
                       " is not allowed; allowed: " + kNameIs);
  };
  for (Body& body : scene.bodies) rename(body.name);
  for (Joint& joint : scene.joints) rename(joint.name);
}

}  // namespace

ObjectRequest with_file_read(ObjectRequest request, const SceneOptions& options) {
  if (request.urdf.empty() || request.urdf.find('<') != std::string::npos) return request;
  std::string file = request.urdf;
  if (file.compare(0, 7, "file://") == 0) file = file.substr(7);
  if (file.compare(0, 10, "package://") == 0)
    file = options.resolve_package_uri ? options.resolve_package_uri(file) : "";
  const auto text = file.empty() ? std::nullopt : file_text(file, kMaxXmlBytes + 1);
  if (!text || text->find('<') == std::string::npos)  // else its text would be taken for a path, and quoted
    throw SceneError(
        kSource + ": no URDF in " + text::quoted(request.urdf, 200) +
        "; allowed: the text of a URDF, or the absolute path or package:// of a file that has it");
  request.urdf = *text;
  request.folder = std::filesystem::path(file).parent_path().string();
  return request;
}

Body requested_body(const ObjectRequest& request, const SceneOptions& options) {
  return scene_of_body(with_file_read(request, options), options).bodies.front();
}

Scene requested_scene(const ObjectRequest& original, const SceneOptions& options) {
  const ObjectRequest request = with_file_read(original, options);
  Scene scene;
  if (!request.whole) return scene_of_body(request, options);
  check_motion(request);
  read_urdf(kSource, request.folder, request.urdf, options, scene);
  if (!request.joints.empty()) apply_joints_yaml(kSource + ": joints", request.joints, scene);
  Pose root = request.pose;
  root.orientation.normalize();
  for (Body& body : scene.bodies) body.start = root * body.start;
  for (Joint& joint : scene.joints) {
    if (joint.parent == Joint::kWorld) joint.in_parent = root * joint.in_parent;
  }
  put_before(request.name, scene);
  join_bodies(kSource, scene);
  check_overlaps(kSource, scene);
  return scene;
}

}  // namespace mrhi
