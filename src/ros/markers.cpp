#include "mr_hand_interaction/ros/markers.h"

#include <visualization_msgs/Marker.h>

#include <algorithm>
#include <cstdio>

#include "body_markers.h"
#include "hand_markers.h"
#include "marker_layers.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "result_conversion.h"

namespace mrhi {
namespace {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

constexpr double kPassing = 0.5;  // hands and contacts go if the node does; the rest is sent again [s]
constexpr double kForEver = 0.0;
constexpr double kRestPeriod = 1.0 / 30;  // [s]

/// Under all that is there at the start, where no hand comes between.
Vector3 below(const Scene& scene) {
  constexpr double kClearance = 0.10;  // [m]
  Vector3 place(0.0, 0.0, 0.15);
  for (const Body& body : scene.bodies) {
    place.z() = std::min(place.z(), body.start.position.z() - body.bounding_radius);
  }
  return place - kClearance * Vector3::UnitZ();
}

std::string heads_up(const Scene& scene, const Configuration& configuration, const SimulationState& state) {
  std::string held;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (!is_held(i, state)) continue;
    const bool assisted = std::any_of(state.grips.begin(), state.grips.end(),
                                      [i](const Grip& grip) { return grip.active && grip.body == i; });
    held += (held.empty() ? "" : ", ") + scene.bodies[i].name + (assisted ? " (with grasp assist)" : "");
  }
  const double g = configuration.gravity.value_or(scene.gravity).norm();
  char gravity[32];
  std::snprintf(gravity, sizeof gravity, "%.2f m/s2", g);
  return "holding: " + (held.empty() ? "nothing" : held) + "  |  " +
         std::string(configuration.contact_model.name) + "  |  gravity: " + (g > 0.0 ? gravity : "none");
}

void add_deleting(int action, const std::pair<std::string, int>& key, const std_msgs::Header& header,
                  MarkerArray& array) {
  array.markers.emplace_back();
  Marker& marker = array.markers.back();
  marker.header = header;
  marker.ns = key.first;
  marker.id = key.second;
  marker.action = action;
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
    : Markers(scene, configuration, Skin::human()) {}
Markers::Markers(const Scene& scene, const Configuration& configuration, const Skin& skin)
    : scene_(scene),
      configuration_(configuration),
      text_place_(below(scene)),
      ground_(ground_height(scene)),
      hands_(std::make_unique<HandMarkers>(skin)),
      bodies_(std::make_unique<BodyMarkers>(scene)) {}
Markers::~Markers() = default;

void Markers::clear() {
  picture_.shown.clear();
  rest_.shown.clear();
  cleared_ = true;
}

void Markers::update(const FrameResult& result, const SimulationState& state, const std_msgs::Header& header,
                     MarkerArray& array) {
  hands_->recycle(array.markers);
  array.markers.clear();
  const bool all = all_due(header.stamp);
  if (std::exchange(cleared_, false)) add_deleting(Marker::DELETEALL, {}, header, array);
  MarkerLayer hands(array, header, "hand", kPassing), ghosts(array, header, "ghost", kPassing);
  MarkerLayer objects(array, header, "objects", kForEver), fixtures(array, header, "fixtures", kForEver);
  MarkerLayer points(array, header, "contacts", kPassing), friction(array, header, "friction", kPassing),
      forces(array, header, "forces", kPassing), newtons(array, header, "newtons", kPassing),
      share(array, header, "share", kPassing);
  int first_id = 0;
  for (std::size_t i = 0; i < result.rendered.size(); ++i, first_id += kIdsPerHand) {
    hands_->add(result.rendered[i], result.tracked[i], first_id, {hands, ghosts});
  }
  add_contacts(scene_, result, {points, friction, forces, newtons, share});
  picture_.delete_gone(header, array);
  bodies_->add(state, result.contacts, all, {objects, fixtures});
}

void Markers::update_rest(const FrameResult& result, const SimulationState& state,
                          const std_msgs::Header& header, MarkerArray& array) {
  hands_->repaint(result.rendered);
  array.markers.clear();
  const bool all = std::exchange(all_of_rest_, false);
  const double since = seconds_between(rest_sent_, header.stamp);
  if (!all && since >= 0.0 && since < kRestPeriod) return;
  rest_sent_ = header.stamp;
  MarkerLayer capsules(array, header, "capsules", kPassing), shadows(array, header, "shadows", kPassing),
      texts(array, header, "text", kForEver);
  int first_id = 0;
  for (std::size_t i = 0; i < result.rendered.size(); ++i, first_id += kIdsPerHand) {
    add_simulated(result.rendered[i], first_id, capsules);
  }
  add_shadows(scene_, state, result, ground_, shadows);
  rest_.delete_gone(header, array);
  std::string text = heads_up(scene_, configuration_, state);
  if (!all && text == text_) return;
  text_ = std::move(text);
  Marker& marker = texts.add(0, Marker::TEXT_VIEW_FACING, {text_place_, Quaternion::Identity()},
                             Vector3::Constant(0.011), color(0.9, 0.9, 0.9));
  marker.text = text_;
}

/// Twice a second, for a viewer that came later or has lost an array.
bool Markers::all_due(const ros::Time& stamp) {
  const double since = seconds_between(all_sent_, stamp);
  const bool due = all_ || cleared_ || since < 0.0 || since >= kPassing;
  if (due) all_sent_ = stamp, all_of_rest_ = true;
  all_ = false;
  return due;
}

void Markers::Passing::delete_gone(const std_msgs::Header& header, MarkerArray& array) {
  now.clear();
  for (const Marker& marker : array.markers) now.emplace_back(marker.ns, marker.id);
  std::sort(now.begin(), now.end());
  for (const Key& key : shown) {
    if (!std::binary_search(now.begin(), now.end(), key)) add_deleting(Marker::DELETE, key, header, array);
  }
  shown.swap(now);
}

}  // namespace mrhi
