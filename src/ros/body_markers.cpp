#include "body_markers.h"

#include <visualization_msgs/Marker.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "../rendering/skin.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"

namespace mrhi {
namespace {

using visualization_msgs::Marker;

/// STL knows none.
bool has_materials(const std::string& mesh) {
  const std::size_t dot = mesh.rfind('.');
  if (dot == std::string::npos) return false;
  const std::string ending = mesh.substr(dot + 1);
  return ending != "stl" && ending != "STL";
}

constexpr double kUnseen = 0.002, kDeep = 0.012;  // depths of a finger that makes a body translucent [m]
constexpr double kLeastOpacity = 0.6;

double opacity_around(double depth) {
  const double seen = std::clamp((depth - kUnseen) / (kDeep - kUnseen), 0.0, 1.0);
  return 1.0 - (1.0 - kLeastOpacity) * seen;
}

bool same(const Pose& a, const Pose& b) {
  return a.position == b.position && a.orientation.coeffs() == b.orientation.coeffs();
}

/// A box in the light that hands are in: rviz's leaves the sides that it does not reach almost black.
Marker& add_box(const Box& box, const Pose& pose, const std_msgs::ColorRGBA& paint, int id,
                MarkerLayer& layer) {
  Marker& marker = layer.add(id, Marker::TRIANGLE_LIST, pose, 2.0 * box.half_extents, paint);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-0.5, 0.5}) {
      const Vector3 out = side * Vector3::Unit(axis), u = 0.5 * Vector3::Unit((axis + 1) % 3),
                    v = std::copysign(0.5, side) * Vector3::Unit((axis + 2) % 3);
      const Rgb light = light_on((pose.orientation * (2.0 * out)).cast<float>()).min(1.0f);
      std_msgs::ColorRGBA lit = paint;
      lit.r *= light[0], lit.g *= light[1], lit.b *= light[2];
      const std::array<Vector3, 6> corners{-u - v, u - v, u + v, -u - v, u + v, -u + v};
      for (const Vector3& corner : corners) {
        marker.points.push_back(to_message(Vector3(out + corner)));
        marker.colors.push_back(lit);
      }
    }
  }
  return marker;
}

/// What rviz has no marker for, as its outermost points in directions all around, in that light. A flat side
/// is one point in all of them, so it serves for what is round.
template <typename Round>
Marker& add_round(const Round& shape, const Pose& pose, const std_msgs::ColorRGBA& paint, int id,
                  MarkerLayer& layer) {
  constexpr int kAround = 24, kRows = 13;  // odd: no row of directions lies across z
  constexpr double kPi = 3.141592653589793;
  Marker& marker = layer.add(id, Marker::TRIANGLE_LIST, pose, Vector3::Ones(), paint);
  const auto direction = [&](int row, int place) -> Vector3 {
    const double up = kPi * (static_cast<double>(row) / kRows - 0.5), turn = 2.0 * kPi / kAround * place;
    return {std::cos(up) * std::cos(turn), std::cos(up) * std::sin(turn), std::sin(up)};
  };
  const auto add = [&](int row, int place) {
    const Vector3 out = direction(row, place);
    const Rgb light = light_on((pose.orientation * out).cast<float>()).min(1.0f);
    std_msgs::ColorRGBA lit = paint;
    lit.r *= light[0], lit.g *= light[1], lit.b *= light[2];
    marker.points.push_back(to_message(shape.farthest(out)));
    marker.colors.push_back(lit);
  };
  for (int row = 0; row < kRows; ++row) {
    for (int place = 0; place < kAround; ++place) {
      add(row, place), add(row, place + 1), add(row + 1, place + 1);
      add(row, place), add(row + 1, place + 1), add(row + 1, place);
    }
  }
  return marker;
}

struct AddShape {
  const Pose& pose;
  const std_msgs::ColorRGBA& paint;
  int id;
  MarkerLayer& layer;

  Marker& operator()(const Sphere& s) const { return add(Marker::SPHERE, Vector3::Constant(2.0 * s.radius)); }
  Marker& operator()(const Box& b) const { return add_box(b, pose, paint, id, layer); }
  Marker& operator()(const Cylinder& c) const {
    return add(Marker::CYLINDER, {2.0 * c.radius, 2.0 * c.radius, 2.0 * c.half_length});
  }
  template <typename Other>
  Marker& operator()(const Other& round) const {
    return add_round(round, pose, paint, id, layer);
  }
  Marker& operator()(const Mesh& m) const {
    Marker& marker = add(Marker::MESH_RESOURCE, m.scale);
    marker.mesh_resource = m.uri;
    return marker;
  }

 private:
  Marker& add(int type, const Vector3& scale) const { return layer.add(id, type, pose, scale, paint); }
};

}  // namespace

Marker& add_shape(const Shape& shape, const Pose& pose, const std_msgs::ColorRGBA& paint, int id,
                  MarkerLayer& layer) {
  return std::visit(AddShape{pose, paint, id, layer}, shape);
}

void BodyMarkers::add(const SimulationState& state, const std::vector<Contact>& contacts, bool all,
                      BodyLayers layers) {
  now_.resize(scene_.bodies.size());
  for (std::size_t i = 0; i < now_.size(); ++i) now_[i] = {state.bodies[i].pose, 1.0};
  for (const Contact& contact : contacts) {
    double& opacity = now_[contact.key.body].opacity;
    opacity = std::min(opacity, opacity_around(contact.depth));
  }
  all = all || added_.size() != now_.size();
  int object_id = 0, fixture_id = 0;
  for (std::size_t i = 0; i < now_.size(); ++i) {
    const Body& body = scene_.bodies[i];
    int& id = body.fixed ? fixture_id : object_id;
    const bool changed = all || !same(now_[i].pose, added_[i].pose) || now_[i].opacity != added_[i].opacity;
    if (changed) add_body(body, now_[i], id, body.fixed ? layers.fixtures : layers.objects);
    id += static_cast<int>(body.visuals.empty() ? body.shapes.size() : body.visuals.size());
  }
  added_.swap(now_);
}

void BodyMarkers::add_body(const Body& body, const Look& look, int first_id, MarkerLayer& layer) const {
  int id = first_id;
  for (const Visual& visual : body.visuals) {
    const auto& c = visual.rgba;
    Marker& marker = add_shape(visual.shape, look.pose * visual.pose,
                               color(c[0], c[1], c[2], look.opacity * c[3]), id++, layer);
    marker.text = body.name;
    if (!visual.has_color && has_materials(marker.mesh_resource)) {
      marker.mesh_use_embedded_materials = true;
      marker.color = color(0.0, 0.0, 0.0, 0.0);  // to rviz: as they are
    }
  }
  if (!body.visuals.empty()) return;
  for (const PlacedShape& placed : body.shapes)
    add_shape(placed.shape, look.pose * placed.pose, color(0.7, 0.7, 0.7, look.opacity), id++, layer).text =
        body.name;
}

}  // namespace mrhi
