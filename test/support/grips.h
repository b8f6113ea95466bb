#pragma once

#include <algorithm>

#include "support/pinch_scene.h"

namespace mrhi::testing {

constexpr double kDegrees = M_PI / 180.0;
constexpr double kFingertipRadius = 0.008;
constexpr double kFingertipLength = 0.025;

/// Adds a phalanx that reaches with its tip to `tip` (a point of its surface) and comes from there along the
/// unit vector `outward`, slanted by `slant` [rad] towards `aside`; the surface it presses has `outward` as
/// normal.
inline void add_fingertip(Hand& hand, int capsule, const Vector3& tip, const Vector3& outward,
                          double slant = 0.0, const Vector3& aside = Vector3::UnitZ()) {
  const Vector3 end = tip + kFingertipRadius * outward;
  const Vector3 axis = std::cos(slant) * outward + std::sin(slant) * aside;
  add_finger(hand, capsule, end + kFingertipLength * axis, end, kFingertipRadius);
}

/// Adds a phalanx that lies along `axis` (unit) with the middle of its surface's line at `point`.
inline void add_flat_finger(Hand& hand, int capsule, const Vector3& point, const Vector3& outward,
                            const Vector3& axis) {
  const Vector3 middle = point + kFingertipRadius * outward;
  add_finger(hand, capsule, middle - 0.5 * kFingertipLength * axis, middle + 0.5 * kFingertipLength * axis,
             kFingertipRadius);
}

/// The whole hand moved rigidly.
inline Hand moved(const Hand& hand, const Pose& by) {
  Hand result = hand;
  result.palm = by * hand.palm;
  result.wrist = by * hand.wrist;
  for (Capsule& capsule : result.capsules) {
    if (capsule.radius <= 0.0) continue;
    capsule.start = by * capsule.start;
    capsule.end = by * capsule.end;
  }
  return result;
}

inline Hand empty_hand(std::uint32_t id = 1, Side side = Side::right) {
  Hand hand;
  hand.id = id;
  hand.side = side;
  hand.palm.position = Vector3(0, 0, -0.1);
  return hand;
}

/// Two equal fingers on opposite sides of a cube of half width `half` along x, `overlap` beyond its surfaces
/// once closed (0.3 s), lying along y.
inline Hand symmetric_pinch(double half, double gap) {
  Hand hand = empty_hand();
  add_flat_finger(hand, capsule_index(1, 3), Vector3(half + gap, 0, 0), Vector3::UnitX(), Vector3::UnitY());
  add_flat_finger(hand, capsule_index(0, 3), Vector3(-half - gap, 0, 0), -Vector3::UnitX(), Vector3::UnitY());
  return hand;
}

/// Fingertip gap of a pinch: 10 mm at first, -overlap from 0.3 s on.
inline double closing_gap(double t, double overlap) {
  return 0.01 - (0.01 + overlap) * smooth(t, 0.3);
}

inline bool has_event(const Simulation& simulation, EventKind kind) {
  const auto& events = simulation.result().events;
  return std::any_of(events.begin(), events.end(), [kind](const Event& event) { return event.kind == kind; });
}

inline Configuration implicit_configuration() {
  return unfiltered(ContactModelKind::implicit);
}

inline Body stiff_box(const Vector3& size, double mass, double stiffness = 2000.0) {
  Body body = box_body(size, mass);
  body.material.stiffness = stiffness;
  return body;
}

inline bool finite(const BodyState& state) {
  return state.pose.position.allFinite() && state.pose.orientation.coeffs().allFinite() &&
         state.linear_momentum.allFinite() && state.angular_momentum.allFinite();
}

}  // namespace mrhi::testing
