#include "mr_hand_interaction/ros/markers.h"

#include <visualization_msgs/Marker.h>

#include <algorithm>
#include <cstdio>

#include "hand_markers.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/ros/result_conversion.h"

namespace mrhi {
namespace {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

constexpr double kPassing = 0.5;  // hands and contacts go if the node does [s]
constexpr double kForEver = 0.0;

/// Under all that is there at the start, where no hand comes between.
Vector3 below(const Scene& scene) {
  constexpr double kClearance = 0.05;  // [m]
  Vector3 place(0.0, 0.0, 0.15);
  for (const Body& body : scene.bodies) {
    place.z() = std::min(place.z(), body.start.position.z() - body.bounding_radius);
  }
  return place - kClearance * Vector3::UnitZ();
}

std::string heads_up(const Scene& scene, const Configuration& configuration, const SimulationState& state) {
  std::string held;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (is_held(i, state)) held += (held.empty() ? "" : ", ") + scene.bodies[i].name;
  }
  const double g = configuration.gravity.value_or(scene.gravity).norm();
  char gravity[32];
  std::snprintf(gravity, sizeof gravity, "%.2f m/s2", g);
  return "holding: " + (held.empty() ? "nothing" : held) + "  |  " + to_string(configuration.contact_model) +
         "  |  gravity: " + (g > 0.0 ? gravity : "none");
}

}  // namespace

std_msgs::ColorRGBA color(double r, double g, double b, double a) {
  std_msgs::ColorRGBA c;
  c.r = static_cast<float>(r);
  c.g = static_cast<float>(g);
  c.b = static_cast<float>(b);
  c.a = static_cast<float>(a);
  return c;
}

Marker& MarkerLayer::add(int id, int type, const Pose& pose, const Vector3& scale,
                         const std_msgs::ColorRGBA& paint) {
  array_.markers.emplace_back();
  Marker& marker = array_.markers.back();
  marker.header = header_;
  marker.ns = name_;
  marker.id = id;
  marker.type = type;
  marker.action = Marker::ADD;
  marker.pose = to_message(pose);
  marker.scale.x = scale.x();
  marker.scale.y = scale.y();
  marker.scale.z = scale.z();
  marker.color = paint;
  marker.lifetime = ros::Duration(lifetime_);
  return marker;
}

Markers::Markers(const Scene& scene, const Configuration& configuration)
    : scene_(scene),
      configuration_(configuration),
      text_place_(below(scene)),
      hands_(std::make_unique<HandMarkers>()) {}
Markers::~Markers() = default;

MarkerArray Markers::update(const FrameResult& result, const SimulationState& state,
                            const std_msgs::Header& header) {
  MarkerArray array;
  MarkerLayer hands(array, header, "hand", kPassing), ghosts(array, header, "ghost", kPassing),
      capsules(array, header, "capsules", kPassing);
  MarkerLayer objects(array, header, "objects", kForEver), fixtures(array, header, "fixtures", kForEver);
  MarkerLayer points(array, header, "contacts", kPassing), friction(array, header, "friction", kPassing),
      forces(array, header, "forces", kPassing), text(array, header, "text", kForEver);
  int first_id = 0;
  for (std::size_t i = 0; i < result.rendered.size(); ++i, first_id += kIdsPerHand) {
    hands_->add(result.rendered[i], result.tracked[i], first_id, {hands, ghosts, capsules});
  }
  add_bodies(scene_, state, false, objects);
  add_bodies(scene_, state, true, fixtures);
  add_contacts(result, {points, friction, forces});
  text.add(0, Marker::TEXT_VIEW_FACING, {text_place_, Quaternion::Identity()}, Vector3::Constant(0.011),
           color(0.9, 0.9, 0.9))
      .text = heads_up(scene_, configuration_, state);
  delete_stale(header, array);
  return array;
}

void Markers::delete_stale(const std_msgs::Header& header, MarkerArray& array) {
  std::set<std::pair<std::string, int>> now;
  for (const Marker& marker : array.markers) now.emplace(marker.ns, marker.id);
  std::vector<Marker> deleted;
  if (cleared_) {
    deleted.emplace_back();
    deleted.back().header = header;
    deleted.back().action = Marker::DELETEALL;
    cleared_ = false;
  }
  for (const auto& [layer, id] : shown_) {
    if (now.count({layer, id}) > 0) continue;
    deleted.emplace_back();
    deleted.back().header = header;
    deleted.back().ns = layer;
    deleted.back().id = id;
    deleted.back().action = Marker::DELETE;
  }
  array.markers.insert(array.markers.begin(), deleted.begin(), deleted.end());
  shown_.swap(now);
}

}  // namespace mrhi
