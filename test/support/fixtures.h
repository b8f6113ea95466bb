#pragma once

#include <cmath>
#include <functional>
#include <string>

#include "mr_hand_interaction/scene/scene.h"
#include "mr_hand_interaction/simulation.h"

namespace mrhi::testing {

constexpr Nanoseconds kStart = 1'000'000'000;

inline Nanoseconds at(double seconds) {
  return kStart + static_cast<Nanoseconds>(std::llround(seconds * 1e9));
}

inline Body box_body(const Vector3& size, double mass) {
  Body body;
  body.name = "object";
  body.mass = mass;
  const Vector3 squares = size.cwiseProduct(size);
  body.inertia = (mass / 12.0 * (Vector3::Constant(squares.sum()) - squares)).asDiagonal();
  body.shapes.push_back({Box{0.5 * size}, {}});
  complete(body);
  return body;
}

inline Body ball_body(double radius, double mass) {
  Body body;
  body.name = "object";
  body.mass = mass;
  body.inertia = 0.4 * mass * radius * radius * Matrix3::Identity();
  body.shapes.push_back({Sphere{radius}, {}});
  complete(body);
  return body;
}

inline Scene scene_of(Body body) {
  Scene scene;
  scene.name = "test";
  scene.bodies.push_back(std::move(body));
  return scene;
}

/// A hand of which only one phalanx was tracked.
inline Hand finger(const Vector3& start, const Vector3& end, double radius,
                   int capsule = capsule_index(1, 3)) {
  Hand hand;
  hand.id = 1;
  hand.capsules[static_cast<std::size_t>(capsule)] = {start, end, radius};
  hand.palm.position = start;
  return hand;
}

inline void add_finger(Hand& hand, int capsule, const Vector3& start, const Vector3& end, double radius) {
  hand.capsules[static_cast<std::size_t>(capsule)] = {start, end, radius};
}

/// Unfiltered and of a strength that nothing stops, so that a scripted hand is where the script says and
/// closed forms hold.
inline Configuration unfiltered(ContactModelKind model = ContactModelKind::seed) {
  Configuration configuration;
  configuration.contact_model = model;
  configuration.contact.hand = HandStrength{};
  configuration.filter.type = FilterKind::none;
  return configuration;
}

/// Feeds `hand_at(t)` at `rate` frames a second from `from` to `to` [s]; `each` sees the simulation after a
/// frame.
inline void play(Simulation& simulation, double from, double to, double rate,
                 const std::function<Hand(double)>& hand_at,
                 const std::function<void(const Simulation&)>& each = nullptr) {
  const int frames = static_cast<int>(std::lround((to - from) * rate));
  for (int i = 0; i <= frames; ++i) {
    const double t = from + i / rate;
    simulation.advance({at(t), {hand_at(t)}});
    if (each) each(simulation);
  }
}

inline Twist object_twist(const Simulation& simulation, std::size_t body = 0) {
  return twist_of(simulation.scene().bodies[body], simulation.state().bodies[body]);
}

}  // namespace mrhi::testing
