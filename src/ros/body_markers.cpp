#include <visualization_msgs/Marker.h>

#include "marker_layers.h"

namespace mrhi {
namespace {

using visualization_msgs::Marker;

/// Marker type and scale of a shape.
struct Look {
  int type;
  Vector3 scale;
  std::string mesh;
};

struct LookOf {
  Look operator()(const Sphere& s) const { return {Marker::SPHERE, Vector3::Constant(2.0 * s.radius), ""}; }
  Look operator()(const Box& b) const { return {Marker::CUBE, 2.0 * b.half_extents, ""}; }
  Look operator()(const Cylinder& c) const {
    return {Marker::CYLINDER, {2.0 * c.radius, 2.0 * c.radius, 2.0 * c.half_length}, ""};
  }
  Look operator()(const Mesh& m) const { return {Marker::MESH_RESOURCE, m.scale, m.uri}; }
};

void add_shape(const Shape& shape, const Pose& pose, const std_msgs::ColorRGBA& paint, int id,
               MarkerLayer& layer) {
  const Look look = std::visit(LookOf{}, shape);
  layer.add(id, look.type, pose, look.scale, paint).mesh_resource = look.mesh;
}

}  // namespace

void add_bodies(const Scene& scene, const SimulationState& state, bool fixed, MarkerLayer& layer) {
  int id = 0;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    if (body.fixed != fixed) continue;
    const Pose& pose = state.bodies[i].pose;
    for (const Visual& visual : body.visuals) {
      const auto& c = visual.rgba;
      add_shape(visual.shape, pose * visual.pose, color(c[0], c[1], c[2], c[3]), id++, layer);
    }
    if (!body.visuals.empty()) continue;
    for (const PlacedShape& placed : body.shapes) {
      add_shape(placed.shape, pose * placed.pose, color(0.7, 0.7, 0.7), id++, layer);
    }
  }
}

}  // namespace mrhi
