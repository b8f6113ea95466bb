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

/// STL knows none.
bool has_materials(const std::string& mesh) {
  const std::size_t dot = mesh.rfind('.');
  if (dot == std::string::npos) return false;
  const std::string ending = mesh.substr(dot + 1);
  return ending != "stl" && ending != "STL";
}

}  // namespace

visualization_msgs::Marker& add_shape(const Shape& shape, const Pose& pose, const std_msgs::ColorRGBA& paint,
                                      int id, MarkerLayer& layer) {
  const Look look = std::visit(LookOf{}, shape);
  Marker& marker = layer.add(id, look.type, pose, look.scale, paint);
  marker.mesh_resource = look.mesh;
  return marker;
}

void add_bodies(const Scene& scene, const SimulationState& state, bool fixed, MarkerLayer& layer) {
  int id = 0;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    if (body.fixed != fixed) continue;
    const Pose& pose = state.bodies[i].pose;
    for (const Visual& visual : body.visuals) {
      const auto& c = visual.rgba;
      Marker& marker =
          add_shape(visual.shape, pose * visual.pose, color(c[0], c[1], c[2], c[3]), id++, layer);
      if (!visual.has_color && has_materials(marker.mesh_resource)) {
        marker.mesh_use_embedded_materials = true;
        marker.color = color(0.0, 0.0, 0.0, 0.0);  // to rviz: as they are
      }
    }
    if (!body.visuals.empty()) continue;
    for (const PlacedShape& placed : body.shapes) {
      add_shape(placed.shape, pose * placed.pose, color(0.7, 0.7, 0.7), id++, layer);
    }
  }
}

}  // namespace mrhi
