#include "mr_hand_interaction/scene/object_request.h"

#include <cmath>

#include "scene_yaml.h"
#include "text.h"
#include "urdf_scene.h"
#include "urdf_tree.h"

namespace mrhi {
namespace {

const std::string kSource = "spawn";  // in place of a file's name

struct Kind {
  const char* name;
  std::size_t numbers;
  const char* sizes;
  urdf::GeometrySharedPtr (*geometry)(const std::vector<double>& size);
  /// Principal moments of a solid of 1 kg.
  Vector3 (*moments)(const std::vector<double>& size);
};

urdf::GeometrySharedPtr box(const std::vector<double>& size) {
  auto shape = std::make_shared<urdf::Box>();
  shape->dim = urdf::Vector3(size[0], size[1], size[2]);
  return shape;
}
Vector3 box_moments(const std::vector<double>& s) {
  const Vector3 squares(s[0] * s[0], s[1] * s[1], s[2] * s[2]);
  return (Vector3::Constant(squares.sum()) - squares) / 12.0;
}

urdf::GeometrySharedPtr sphere(const std::vector<double>& size) {
  auto shape = std::make_shared<urdf::Sphere>();
  shape->radius = size[0];
  return shape;
}
Vector3 sphere_moments(const std::vector<double>& s) {
  return Vector3::Constant(0.4 * s[0] * s[0]);
}

urdf::GeometrySharedPtr cylinder(const std::vector<double>& size) {
  auto shape = std::make_shared<urdf::Cylinder>();
  shape->radius = size[0];
  shape->length = size[1];
  return shape;
}
Vector3 cylinder_moments(const std::vector<double>& s) {
  const double across = (3.0 * s[0] * s[0] + s[1] * s[1]) / 12.0;
  return {across, across, 0.5 * s[0] * s[0]};
}

const Kind kKinds[] = {{"box", 3, "x, y, z", box, box_moments},
                       {"sphere", 1, "radius", sphere, sphere_moments},
                       {"cylinder", 2, "radius, length", cylinder, cylinder_moments}};

const Kind& kind_of(const std::string& name) {
  for (const Kind& kind : kKinds) {
    if (kind.name == name) return kind;
  }
  throw SceneError(kSource + ": shape '" + text::one_line(name, 60) +
                   "' is not known; allowed: box, cylinder, sphere, or a URDF in its place");
}

PlacedLink placed_shape(const ObjectRequest& request) {
  const Kind& kind = kind_of(request.shape);
  if (request.size.size() != kind.numbers) {
    throw SceneError(kSource + ": size of a " + kind.name + " has " + std::to_string(request.size.size()) +
                     " numbers; allowed: " + std::to_string(kind.numbers) + " (" + kind.sizes + ") [m]");
  }
  auto link = std::make_shared<urdf::Link>();
  auto collision = std::make_shared<urdf::Collision>();
  collision->geometry = kind.geometry(request.size);
  link->collision_array = {collision};
  const Vector3 moments = request.mass * kind.moments(request.size);
  link->inertial = std::make_shared<urdf::Inertial>();
  link->inertial->mass = request.mass;
  link->inertial->ixx = moments.x();
  link->inertial->iyy = moments.y();
  link->inertial->izz = moments.z();
  link->name = request.name;
  return {link, request.mass == 0.0, request.pose};
}

PlacedLink placed_urdf(const ObjectRequest& request) {
  PlacedLink placed = only_link(kSource, request.urdf);
  placed.in_world = request.pose;
  if (request.name.empty()) return placed;
  auto renamed = std::make_shared<urdf::Link>(*placed.link);
  renamed->name = request.name;
  placed.link = renamed;
  return placed;
}

void check_motion(const ObjectRequest& request) {
  const Pose& pose = request.pose;
  const bool unit = std::abs(pose.orientation.norm() - 1.0) < 0.01;  // not for NaN either
  if (!pose.position.allFinite() || !unit) {
    throw SceneError(kSource + ": this pose is not allowed; allowed: finite numbers, a unit quaternion");
  }
  if (!request.twist.linear.allFinite() || !request.twist.angular.allFinite()) {
    throw SceneError(kSource + ": this twist is not allowed; allowed: finite numbers");
  }
}

}  // namespace

Body requested_body(const ObjectRequest& request, const SceneOptions& options) {
  check_motion(request);
  PlacedLink placed = request.urdf.empty() ? placed_shape(request) : placed_urdf(request);
  placed.in_world.orientation.normalize();
  Body body = read_body(kSource, placed, options);
  body.start_twist = request.twist;
  if (request.rgba) {
    for (Visual& visual : body.visuals) visual.rgba = *request.rgba;
  }
  if (!request.material.empty()) apply_material_yaml(kSource + ": material", request.material, body);
  return body;
}

}  // namespace mrhi
