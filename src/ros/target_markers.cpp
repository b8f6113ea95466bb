#include <visualization_msgs/Marker.h>

#include <algorithm>

#include "marker_layers.h"

namespace mrhi {
namespace {

using visualization_msgs::Marker;

constexpr double kRingRoom = 1.15;   // radius of the ring, of the body's bounding radius
constexpr double kRingWidth = 0.12;  // of its radius
constexpr double kShell = 1.12;      // of a highlight, of the body's size
constexpr double kShaft = 0.035;     // of the arrow that points at it [m]
constexpr double kGap = 0.012;       // between the two [m]

Pose level_at(const Vector3& place) {
  return {place, Quaternion::Identity()};
}

std_msgs::ColorRGBA to_take(double alpha) {
  return color(0.941, 0.894, 0.259, alpha);
}

/// Returns the id that follows.
int add_form(const Body& body, const Pose& pose, const std_msgs::ColorRGBA& paint, double size, int id,
             MarkerLayer& layer) {
  const auto add = [&](const Shape& shape, const Pose& place) {
    Marker& marker = add_shape(shape, pose * place, paint, id++, layer);
    for (double* const scale : {&marker.scale.x, &marker.scale.y, &marker.scale.z}) *scale *= size;
  };
  for (const Visual& visual : body.visuals) add(visual.shape, visual.pose);
  if (body.visuals.empty()) {
    for (const PlacedShape& placed : body.shapes) add(placed.shape, placed.pose);
  }
  return id;
}

}  // namespace

void add_target(const TargetMark& target, int first_id, MarkerLayer& layer) {
  const double form = target.waits ? 0.12 : 0.35, filled = target.waits ? 0.25 : 1.0;
  const auto paint = [&](double alpha) {
    return target.reached ? color(0.000, 0.620, 0.451, alpha) : color(0.337, 0.706, 0.914, alpha);
  };
  const int id = add_form(target.body, target.pose, paint(form), 1.0, first_id, layer);
  Marker& ring = layer.add(id, Marker::TRIANGLE_LIST, Pose{}, Vector3::Ones(), color(1.0, 1.0, 1.0));
  const double inner = ring_radius(target.body), outer = (1.0 + kRingWidth) * inner;
  const double progress = std::min(1.0, std::max(0.0, target.progress));
  add_ring({inner, outer, 0.0, progress}, level_at(target.pose.position), ring);
  ring.colors.resize(ring.points.size(), paint(filled));
  add_ring({inner, outer, progress, 1.0}, level_at(target.pose.position), ring);
  ring.colors.resize(ring.points.size(), color(0.9, 0.9, 0.9, 0.3 * filled));
}

double ring_radius(const Body& body) {
  return kRingRoom * body.bounding_radius;
}

void add_highlight(const Body& body, const Pose& pose, int first_id, MarkerLayer& layer) {
  const int id = add_form(body, pose, to_take(0.45), kShell, first_id, layer);
  const Vector3 tip = pose.position + (body.bounding_radius + kGap) * Vector3::UnitZ();
  add_arrow({tip + kShaft * Vector3::UnitZ(), tip, 0.003, 0.008, 0.018}, to_take(1.0), id, layer);
}

}  // namespace mrhi
