#include "mr_hand_interaction/ros/markers.h"

#include <visualization_msgs/Marker.h>

#include <algorithm>
#include <cstdio>

#include "body_markers.h"
#include "hand_markers.h"
#include "marker_layers.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"

namespace mrhi {
namespace {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

constexpr double kPassing = 0.5;  // hands and contacts go if the node does; the rest is sent again [s]
constexpr double kForEver = 0.0;

/// Under all that is there at the start, where no hand comes between.
Vector3 below(const Scene& scene) {
  constexpr double kClearance = 0.10;  // [m]
  Vector3 place(0.0, 0.0, 0.15);
  for (const Body& body : scene.bodies) {
    place.z() = std::min(place.z(), body.start.position.z() - body.bounding_radius);
  }
  return place - kClearance * Vector3::UnitZ();
}

std::string held_by_hands(const Scene& scene, const SimulationState& state) {
  std::string held;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (!is_held(i, state)) continue;
    const bool assisted = std::any_of(state.grips.begin(), state.grips.end(),
                                      [i](const Grip& grip) { return grip.active && grip.body == i; });
    held += (held.empty() ? "" : ", ") + scene.bodies[i].name + (assisted ? " (with grasp assist)" : "");
  }
  return "holding: " + (held.empty() ? "nothing" : held);
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

std::string caption(const std::string& contact_model, const Vector3& gravity) {
  const double g = gravity.norm();
  char text[32];
  std::snprintf(text, sizeof text, "%.2f m/s2", g);
  return contact_model + "  |  gravity: " + (g > 0.0 ? text : "none");
}

Markers::Markers(const Scene& scene, std::string caption, PictureStyle style)
    : scene_(scene),
      caption_(std::move(caption)),
      style_(style),
      text_place_(below(scene)),
      hands_(std::make_unique<HandMarkers>(Skin::human())),
      bodies_(std::make_unique<BodyMarkers>(scene)),
      shadows_(std::make_unique<ShadowMarkers>(scene, ground_height(scene))),
      impacts_(std::make_unique<ImpactMarkers>()) {}
Markers::Markers(const Scene& scene, const Configuration& configuration, PictureStyle style)
    : Markers(scene,
              mrhi::caption(std::string(configuration.contact_model.name),
                            configuration.gravity.value_or(scene.gravity)),
              style) {}
Markers::~Markers() = default;

void Markers::clear() {
  shown_.clear();
  cleared_ = true;
}

void Markers::note(const FrameResult& result, const ros::Time& stamp) {
  impacts_->note(result.contacts, stamp);
}

void Markers::update(const FrameResult& result, const SimulationState& state, const std_msgs::Header& header,
                     MarkerArray& array) {
  hands_->recycle(array.markers);
  array.markers.clear();
  const bool all = all_due(header.stamp);
  if (std::exchange(cleared_, false)) add_deleting(Marker::DELETEALL, {}, header, array);
  MarkerLayer hands(array, header, "hand", kPassing), ghosts(array, header, "ghost", kPassing),
      capsules(array, header, "capsules", kPassing);
  MarkerLayer objects(array, header, "objects", kForEver), fixtures(array, header, "fixtures", kForEver);
  MarkerLayer points(array, header, "contacts", kPassing), friction(array, header, "friction", kPassing),
      forces(array, header, "forces", kPassing), newtons(array, header, "newtons", kPassing),
      share(array, header, "share", kPassing), impacts(array, header, "impacts", kPassing);
  MarkerLayer shadows(array, header, "shadows", kForEver), texts(array, header, "text", kForEver);
  int first_id = 0;
  for (std::size_t i = 0; i < result.rendered.size(); ++i, first_id += kIdsPerHand) {
    hands_->add(result.rendered[i], result.tracked[i], result, state, style_, first_id, {hands, ghosts});
    add_simulated(result.rendered[i], first_id, capsules);
  }
  add_contacts(scene_, result, style_, {points, friction, forces, newtons, share});
  impacts_->add(header.stamp, style_, impacts);
  delete_gone(header, array);
  bodies_->add(state, result.contacts, all, {objects, fixtures});
  shadows_->add(state, result, all, shadows);
  std::string text = held_by_hands(scene_, state) + "  |  " + caption_;
  if (!all && text == text_) return;
  text_ = std::move(text);
  texts
      .add(0, Marker::TEXT_VIEW_FACING, {text_place_, Quaternion::Identity()}, Vector3::Constant(0.011),
           color(0.9, 0.9, 0.9))
      .text = text_;
}

/// Twice a second, for a viewer that came later or has lost an array.
bool Markers::all_due(const ros::Time& stamp) {
  const double since = seconds_between(all_sent_, stamp);
  const bool due = all_ || cleared_ || since < 0.0 || since >= kPassing;
  if (due) all_sent_ = stamp;
  all_ = false;
  return due;
}

void Markers::delete_gone(const std_msgs::Header& header, MarkerArray& array) {
  now_.clear();
  for (const Marker& marker : array.markers) now_.emplace_back(marker.ns, marker.id);
  std::sort(now_.begin(), now_.end());
  for (const Key& key : shown_) {
    if (!std::binary_search(now_.begin(), now_.end(), key)) add_deleting(Marker::DELETE, key, header, array);
  }
  shown_.swap(now_);
}

}  // namespace mrhi
