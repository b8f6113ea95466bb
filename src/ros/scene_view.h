#pragma once

#include <mr_hand_interaction/HandFrame.h>
#include <mr_hand_interaction/RenderedView.h>
#include <mr_hand_interaction/SceneDescription.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "../rendering/renderer.h"
#include "../scene/shape_kinds.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/simulation.h"
#include "result_messages.h"

namespace mrhi {

inline Shape shape_of(const mr_hand_interaction::SceneShape& message) {
  const bool is_mesh = message.type == mr_hand_interaction::SceneShape::MESH;
  const ShapeKind* const kind =
      message.type < kShapeTypes.size() ? find_shape_kind(kShapeTypes[message.type]) : nullptr;
  if (is_mesh ? !message.size.empty() : kind == nullptr || message.size.size() != kind->sizes.size())
    throw std::invalid_argument("shape of type " + std::to_string(message.type) + " with " +
                                std::to_string(message.size.size()) +
                                " sizes is not allowed; allowed: see SceneShape.msg");
  if (kind != nullptr) return kind->make(message.size);
  auto mesh = std::make_shared<TriangleMesh>();
  for (const auto& point : message.vertices)
    mesh->vertices.push_back(Eigen::Vector3f(point.x, point.y, point.z).cast<double>());
  const auto vertices = static_cast<std::uint32_t>(mesh->vertices.size());
  for (std::size_t i = 0; i + 2 < message.triangles.size(); i += 3) {
    const std::uint32_t *const corner = &message.triangles[i], last = *std::max_element(corner, corner + 3);
    if (last >= vertices)
      throw std::invalid_argument("mesh '" + message.mesh + "' with vertex " + std::to_string(last) +
                                  " in a triangle is not allowed; allowed: 0 to " + std::to_string(vertices) +
                                  ", exclusive");
    mesh->triangles.push_back(
        {static_cast<int>(corner[0]), static_cast<int>(corner[1]), static_cast<int>(corner[2])});
  }
  return Mesh{std::move(mesh), message.mesh, from_message(message.scale)};
}

inline Body body_of(const mr_hand_interaction::SceneBody& message) {
  Body body;
  body.name = message.name;
  body.fixed = message.fixed;
  body.is_operator = message.is_operator;
  body.link_in_body.position = from_message(message.link);
  body.start = from_message(message.pose);
  body.material.static_friction = message.static_friction;
  body.material.dynamic_friction = message.dynamic_friction;
  for (const auto& shape : message.shapes) {
    body.shapes.push_back({shape_of(shape), from_message(shape.pose)});
    const PlacedShape& placed = body.shapes.back();
    body.bounding_radius =
        std::max(body.bounding_radius, placed.pose.position.norm() + bounding_radius(placed.shape));
  }
  for (const auto& shape : message.visuals) {
    const auto& c = shape.color;
    Visual visual;
    visual.shape = shape_of(shape);
    visual.pose = from_message(shape.pose);
    visual.has_color = c.a > 0.0f || !std::holds_alternative<Mesh>(visual.shape);
    if (visual.has_color) visual.rgba = {{c.r, c.g, c.b, c.a}};
    body.visuals.push_back(std::move(visual));
  }
  return body;
}

/// A simulation as seen in its messages, for drawing Markers and skins in another process. Its take functions
/// throw std::invalid_argument with an invalid value, and then change nothing.
class SceneView {
 public:
  SceneView() { state_.hands.resize(kMaxHands); }
  void take(const mr_hand_interaction::SceneDescription& description) {
    Scene scene;
    scene.name = description.name;
    scene.gravity = from_message(description.gravity);
    for (const auto& body : description.bodies) scene.bodies.push_back(body_of(body));
    model_ = description.model;
    scene_ = std::move(scene);
    state_ = SimulationState();
    for (const Body& body : scene_.bodies) state_.bodies.push_back(start_state(body));
    state_.interactions.resize(scene_.bodies.size());
    state_.hands.resize(kMaxHands);
    result_ = FrameResult();
  }
  void take(const mr_hand_interaction::RenderedView& view) {
    const std::vector<Hand> rendered = hands_of(view.rendered_hands);
    tracked_ = hands_of(view.tracked_hands);
    take_rendered(rendered);
    take_objects(view.objects);
    take_contacts(view.contacts);
  }
  /// Removes hands and contacts, which nobody has reported for a while.
  void remove_hands() { take(mr_hand_interaction::RenderedView()); }

  const std::string& model() const { return model_; }  ///< contact model
  const Scene& scene() const { return scene_; }
  /// Poses of bodies, held bodies, and ids of hands.
  const SimulationState& state() const { return state_; }
  /// Rendered hands with their loads, the corresponding tracked hands, and contacts.
  const FrameResult& result() {
    result_.tracked.clear();
    for (std::size_t i = 0; i < result_.rendered.size(); ++i) {
      RenderedHand& rendered = result_.rendered[i];
      note_touches(result_.contacts, static_cast<int>(i), rendered);
      const auto tracked = std::find_if(tracked_.begin(), tracked_.end(),
                                        [&](const Hand& hand) { return hand.id == rendered.hand.id; });
      result_.tracked.push_back(tracked != tracked_.end() ? *tracked : rendered.hand);
    }
    return result_;
  }

 private:
  static std::vector<Hand> hands_of(const std::vector<mr_hand_interaction::Hand>& hands) {
    mr_hand_interaction::HandFrame frame;
    frame.hands = hands;
    return from_message(frame).hands;
  }
  void take_objects(const std::vector<mr_hand_interaction::ObjectState>& objects) {
    result_.assists.clear();
    for (const auto& object : objects) {
      const auto index = find_body(scene_, object.name);
      if (!index) continue;
      const std::size_t i = *index;
      state_.bodies[i].pose = from_message(object.pose);
      // Bodies of this scene have unit mass and inertia by default.
      state_.bodies[i].linear_momentum = from_message(object.twist.linear);
      state_.bodies[i].angular_momentum = from_message(object.twist.angular);
      state_.interactions[i].level = object.held ? InteractionLevel::grasp : InteractionLevel::none;
      if (object.assisted)
        result_.assists.push_back({0, static_cast<std::uint16_t>(i), from_message(object.assist_force),
                                   from_message(object.assist_torque)});
    }
  }
  void take_contacts(const std::vector<mr_hand_interaction::Contact>& contacts) {
    result_.contacts.clear();
    for (const auto& message : contacts) {
      const auto body = find_body(scene_, message.object);
      std::size_t hand = 0;
      while (hand < result_.rendered.size() && result_.rendered[hand].hand.id != message.hand_id) ++hand;
      const int capsule = message.finger == mr_hand_interaction::Phalanx::PALM
                              ? kPalm
                              : capsule_index(message.finger, message.bone);
      if (!body || hand >= result_.rendered.size() || capsule > kPalm) continue;
      Contact contact;
      contact.key.body = static_cast<std::uint16_t>(*body);
      contact.key.hand = static_cast<std::uint8_t>(hand);
      contact.key.capsule = static_cast<std::uint8_t>(capsule);
      contact.point = from_message(message.position);
      contact.normal = from_message(message.normal);
      contact.depth = message.depth;
      contact.impulse = from_message(message.impulse);
      contact.force = from_message(message.force);
      contact.friction =
          message.phase == mr_hand_interaction::Contact::SLIPPING ? Friction::slipping : Friction::sticking;
      contact.radius = result_.rendered[hand].hand.capsules[capsule].radius;
      result_.contacts.push_back(contact);
    }
  }
  void take_rendered(const std::vector<Hand>& hands) {
    result_.rendered.clear();
    for (const Hand& hand : hands) {
      if (result_.rendered.size() == state_.hands.size()) break;
      state_.hands[result_.rendered.size()].current = hand;
      result_.rendered.push_back({hand, {}, {}});
    }
  }
  std::string model_;
  Scene scene_;
  SimulationState state_;
  FrameResult result_;
  std::vector<Hand> tracked_;
};

}  // namespace mrhi
