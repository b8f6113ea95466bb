#include <visualization_msgs/Marker.h>

#include <algorithm>

#include "marker_layers.h"

namespace mrhi {
namespace {

using visualization_msgs::Marker;

constexpr double kRingRoom = 1.15;   // radius of the ring, of the body's bounding radius
constexpr double kRingWidth = 0.12;  // of its radius

Pose level_at(const Vector3& place) {
  return {place, Quaternion::Identity()};
}

}  // namespace

void add_target(const TargetMark& target, int first_id, MarkerLayer& layer) {
  const auto paint = [&](double alpha) {
    return target.reached ? color(0.000, 0.620, 0.451, alpha) : color(0.337, 0.706, 0.914, alpha);
  };
  int id = first_id;
  for (const Visual& visual : target.body.visuals)
    add_shape(visual.shape, target.pose * visual.pose, paint(0.35), id++, layer);
  if (target.body.visuals.empty()) {
    for (const PlacedShape& placed : target.body.shapes)
      add_shape(placed.shape, target.pose * placed.pose, paint(0.35), id++, layer);
  }
  Marker& ring = layer.add(id, Marker::TRIANGLE_LIST, Pose{}, Vector3::Ones(), color(1.0, 1.0, 1.0));
  const double inner = kRingRoom * target.body.bounding_radius, outer = (1.0 + kRingWidth) * inner;
  const double progress = std::min(1.0, std::max(0.0, target.progress));
  add_ring({inner, outer, 0.0, progress}, level_at(target.pose.position), ring);
  ring.colors.resize(ring.points.size(), paint(1.0));
  add_ring({inner, outer, progress, 1.0}, level_at(target.pose.position), ring);
  ring.colors.resize(ring.points.size(), color(0.9, 0.9, 0.9, 0.3));
}

}  // namespace mrhi
