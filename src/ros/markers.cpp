#include "mr_hand_interaction/ros/markers.h"

#include <algorithm>
#include <array>
#include <boost/algorithm/string/predicate.hpp>
#include <cmath>

#include "../math/rotation.h"
#include "../rendering/skin.h"
#include "../simulation/contact_phase.h"
#include "../text/text.h"
#include "marker_layers.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"

namespace mrhi {
namespace {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

/// Below all bodies at the start, clear of the hands' workspace.
Vector3 below(const Scene& scene) {
  constexpr double kClearance = 0.10;  // [m]
  Vector3 place(0.0, 0.0, 0.15);
  for (const Body& body : scene.bodies) {
    place.z() = std::min(place.z(), body.start.position.z() - body.bounding_radius);
  }
  return place - kClearance * Vector3::UnitZ();
}

std::string held_by_hands(const Scene& scene, const FrameResult& result, const SimulationState& state) {
  std::vector<std::string> held;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (is_held(i, state))
      held.push_back(scene.bodies[i].name + (assist_on(i, result) ? " (with grasp assist)" : ""));
  }
  return "holding: " + (held.empty() ? "nothing" : text::joined(held));
}

/// Linear and angular speed of each operator; empty without operators.
std::string motion_of_operators(const Scene& scene, const SimulationState& state) {
  std::string all;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (!scene.bodies[i].is_operator) continue;
    const Twist twist = twist_of(scene.bodies[i], state.bodies[i]);
    all += "\n" + scene.bodies[i].name +
           text::format(": %.3f m/s, %.1f deg/s", twist.linear.norm(), twist.angular.norm() / kDegree);
  }
  return all;
}

// Depths of a finger that make a body translucent [m]: a firm grasp closes 10 mm into what it holds, which
// stays almost opaque.
constexpr double kFadeBegin = 0.006, kFadeEnd = 0.025;
constexpr double kMinOpacity = 0.6;

/// A mesh stays opaque: viewers do not sort its triangles, so its far side would show through.
bool may_be_translucent(const Body& body) {
  const std::vector<Visual> shapes = drawn_shapes(body);
  return std::none_of(shapes.begin(), shapes.end(),
                      [](const Visual& drawn) { return std::holds_alternative<Mesh>(drawn.shape); });
}

bool same(const Pose& a, const Pose& b) {
  return a.position == b.position && a.orientation.coeffs() == b.orientation.coeffs();
}

/// Adds a shape to a layer.
struct ShapeMarker {
  const Pose& pose;
  const std_msgs::ColorRGBA& paint;
  int id;
  const MarkerLayer& layer;

  Marker& operator()(const Sphere& s) const { return add(Marker::SPHERE, Vector3::Constant(2.0 * s.radius)); }
  Marker& operator()(const Cylinder& c) const {
    return add(Marker::CYLINDER, {2.0 * c.radius, 2.0 * c.radius, 2.0 * c.half_length});
  }
  Marker& operator()(const Mesh& m) const {
    Marker& marker = add(Marker::MESH_RESOURCE, m.scale);
    marker.mesh_resource = m.uri;
    return marker;
  }

  /// Lit like hands: rviz's own box has averted sides that are almost black.
  Marker& operator()(const Box& box) const {
    Marker& marker = add(Marker::TRIANGLE_LIST, 2.0 * box.half_extents);
    for (int axis = 0; axis < 3; ++axis) {
      for (const double side : {-0.5, 0.5}) {
        const Vector3 out = side * Vector3::Unit(axis), u = 0.5 * Vector3::Unit((axis + 1) % 3),
                      v = std::copysign(0.5, side) * Vector3::Unit((axis + 2) % 3);
        for (const Vector3& corner : std::array<Vector3, 6>{-u - v, u - v, u + v, -u - v, u + v, -u + v})
          add_lit(out + corner, pose.orientation * (2.0 * out), paint, marker);
      }
    }
    return marker;
  }

  /// A round shape without a marker type in rviz, by its support points all around.
  template <typename Round>
  Marker& operator()(const Round& shape) const {
    constexpr int kAround = 24, kRows = 13;  // odd: no row of directions is perpendicular to z
    Marker& marker = add(Marker::TRIANGLE_LIST, Vector3::Ones());
    const auto add_point = [&](int row, int place) {
      const double up = M_PI * (static_cast<double>(row) / kRows - 0.5), turn = 2.0 * M_PI / kAround * place;
      const Vector3 out(std::cos(up) * std::cos(turn), std::cos(up) * std::sin(turn), std::sin(up));
      add_lit(shape.farthest(out), pose.orientation * out, paint, marker);
    };
    for (int row = 0; row < kRows; ++row) {
      for (int place = 0; place < kAround; ++place) {
        add_point(row, place), add_point(row, place + 1), add_point(row + 1, place + 1);
        add_point(row, place), add_point(row + 1, place + 1), add_point(row + 1, place);
      }
    }
    return marker;
  }

 private:
  Marker& add(int type, const Vector3& scale) const { return layer.add(id, type, pose, scale, paint); }
};

void add_deleting(int action, const std::pair<std::string, int>& key, const std_msgs::Header& header,
                  MarkerArray& array) {
  Marker& marker = array.markers.emplace_back();
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

void add_lit(const Vector3& point, const Vector3& normal, const std_msgs::ColorRGBA& paint, Marker& marker) {
  const Rgb light = light_on(normal.cast<float>()).min(1.0f);
  std_msgs::ColorRGBA colour = paint;
  colour.r *= light[0], colour.g *= light[1], colour.b *= light[2];
  marker.points.push_back(to_message(point));
  marker.colors.push_back(colour);
}

Marker& MarkerLayer::add(int id, int type, const Pose& pose, const Vector3& scale,
                         const std_msgs::ColorRGBA& paint) const {
  Marker& marker = array.markers.emplace_back();
  marker.header = header;
  marker.ns = name;
  marker.id = id;
  marker.type = type;
  marker.action = Marker::ADD;
  marker.pose = to_message(pose);
  marker.scale.x = scale.x();
  marker.scale.y = scale.y();
  marker.scale.z = scale.z();
  marker.color = paint;
  marker.lifetime = ros::Duration(lifetime);
  return marker;
}

std::string caption(const std::string& contact_model, const Vector3& gravity) {
  const double g = gravity.norm();
  return contact_model + "  |  gravity: " + (g > 0.0 ? text::format("%.2f m/s2", g) : "none");
}

std::vector<Visual> drawn_shapes(const Body& body) {
  if (!body.visuals.empty()) return body.visuals;
  std::vector<Visual> shapes;
  for (const PlacedShape& placed : body.shapes) {
    shapes.push_back({placed.shape, placed.pose});
    shapes.back().has_color = true;
  }
  return shapes;
}

Marker& add_shape(const Shape& shape, const Pose& pose, const std_msgs::ColorRGBA& paint, int id,
                  const MarkerLayer& layer) {
  return std::visit(ShapeMarker{pose, paint, id, layer}, shape);
}

/// Draws the bodies of a scene, in layers `objects` and `fixtures`. A body without a mesh that a tracked
/// finger penetrates becomes translucent, so that the ghost is visible.
class BodyMarkers {
 public:
  explicit BodyMarkers(const Scene& scene) : scene_(scene) {}  ///< keeps a reference

  /// Adds bodies whose appearance has changed, or all.
  void add(const SimulationState& state, const std::vector<Contact>& contacts, bool all,
           const MarkerLayers& layers) {
    const MarkerLayer objects = layers.layer("objects", kNoExpiry),
                      fixtures = layers.layer("fixtures", kNoExpiry);
    now_.resize(scene_.bodies.size());
    for (std::size_t i = 0; i < now_.size(); ++i) now_[i] = {state.bodies[i].pose, 1.0};
    for (const Contact& contact : contacts) {
      if (!may_be_translucent(scene_.bodies[contact.key.body])) continue;
      const double seen = std::clamp((contact.depth - kFadeBegin) / (kFadeEnd - kFadeBegin), 0.0, 1.0);
      double& opacity = now_[contact.key.body].opacity;
      opacity = std::min(opacity, 1.0 - (1.0 - kMinOpacity) * seen);
    }
    all = all || added_.size() != now_.size();
    int object_id = 0, fixture_id = 0;
    for (std::size_t i = 0; i < now_.size(); ++i) {
      const Body& body = scene_.bodies[i];
      const bool changed = all || !same(now_[i].pose, added_[i].pose) || now_[i].opacity != added_[i].opacity;
      for (const Visual& drawn : drawn_shapes(body)) {
        const int id = (body.fixed ? fixture_id : object_id)++;
        if (changed) add_part(drawn, now_[i], body.name, id, body.fixed ? fixtures : objects);
      }
    }
    added_.swap(now_);
  }

 private:
  struct Appearance {
    Pose pose;
    double opacity = 1.0;
  };
  static void add_part(const Visual& drawn, const Appearance& appearance, const std::string& body, int id,
                       const MarkerLayer& layer) {
    const auto& c = drawn.rgba;
    Marker& marker = add_shape(drawn.shape, appearance.pose * drawn.pose,
                               color(c[0], c[1], c[2], appearance.opacity * c[3]), id, layer);
    marker.text = body;
    const std::string& mesh = marker.mesh_resource;
    if (drawn.has_color || mesh.empty() || boost::iends_with(mesh, ".stl")) return;  // STL has no materials
    marker.mesh_use_embedded_materials = true;
    marker.color = color(0.0, 0.0, 0.0, 0.0);  // rviz then keeps the mesh's materials
  }

  const Scene& scene_;
  std::vector<Appearance> added_, now_;
};

struct Markers::Parts {
  explicit Parts(const Scene& scene) : bodies(scene), shadows(scene, ground_height(scene)) {}

  HandMarkers hands;
  BodyMarkers bodies;
  ShadowMarkers shadows;
  ImpactMarkers impacts;
};

Markers::Markers(const Scene& scene, std::string caption, PictureStyle style)
    : scene_(scene),
      caption_(std::move(caption)),
      style_(style),
      text_place_(below(scene)),
      parts_(std::make_unique<Parts>(scene)) {}
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
  parts_->impacts.note(result.contacts, stamp);
}

void Markers::update(const FrameResult& result, const SimulationState& state, const std_msgs::Header& header,
                     MarkerArray& array) {
  parts_->hands.recycle(array.markers);
  array.markers.clear();
  const bool all = all_due(header.stamp);
  if (std::exchange(cleared_, false)) add_deleting(Marker::DELETEALL, {}, header, array);
  const MarkerLayers layers{array, header};
  parts_->hands.add(result, state, style_, layers);
  add_contacts(scene_, result, state, style_, layers);
  parts_->impacts.add(header.stamp, style_, layers.layer("impacts"));
  delete_gone(header, array);
  parts_->bodies.add(state, result.contacts, all, layers);
  parts_->shadows.add(state, result, all, layers.layer("shadows", kNoExpiry));
  std::string text =
      held_by_hands(scene_, result, state) + "  |  " + caption_ + motion_of_operators(scene_, state);
  if (!all && text == text_) return;
  text_ = std::move(text);
  layers.layer("text", kNoExpiry)
      .add(0, Marker::TEXT_VIEW_FACING, {text_place_}, Vector3::Constant(0.011), color(0.9, 0.9, 0.9))
      .text = text_;
}

/// Twice a second, for a viewer that has joined later or has missed an array.
bool Markers::all_due(const ros::Time& stamp) {
  const double since = seconds_between(all_sent_, stamp);
  const bool due = all_ || cleared_ || since < 0.0 || since >= kTransientLifetime;
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
