#pragma once

#include "support/grips.h"

namespace mrhi::testing {

const Vector3 kPip(0.02, 0.2, 0.02);    // [m]
constexpr double kPipMass = 0.05;       // [kg]
constexpr double kOverEdge = 0.0035;    // the tips' middles above the upper face [m]
constexpr double kEdgeOverlap = 0.003;  // by which each tip moves on after the touch [m]

/// Two upright fingertips close along x on the upper edges of a bar: each bears on its edge at 26 degrees to
/// the side face as they touch, at 41 degrees once closed, outside the cone of friction (38.7 degrees).
inline Hand closing_on_the_edges(double t) {
  const double touch = std::sqrt(kFingertipRadius * kFingertipRadius - kOverEdge * kOverEdge);
  const double x = 0.5 * kPip.x() + touch + closing_gap(t, kEdgeOverlap);
  const double z = 0.5 * kPip.z() + kOverEdge;
  Hand hand = empty_hand();
  for (const int finger : {0, 1}) {
    const Vector3 end(finger == 0 ? -x : x, 0.0, z);
    add_finger(hand, capsule_index(finger, 3), end + kFingertipLength * Vector3::UnitZ(), end,
               kFingertipRadius);
  }
  return hand;
}

/// How far the bar is out of the hand, which shakes it by 2 cm at 2 Hz across and along the edges for two
/// seconds [m].
inline double squeezed_out(const Configuration& configuration) {
  Simulation simulation(scene_of(stiff_box(kPip, kPipMass)), configuration);
  const Vector3 way = 0.02 * Vector3(1, 1, 1).normalized();
  const auto shake = [&](double t) -> Vector3 {
    return smooth(t - 1.0, 0.5) * (1.0 - smooth(t - 3.0, 0.5)) * std::sin(2.0 * M_PI * 2.0 * (t - 1.0)) * way;
  };
  play(simulation, 0.0, 4.5, 120.0, [&](double t) {
    Pose pose;
    pose.position = shake(t);
    return moved(closing_on_the_edges(t), pose);
  });
  return simulation.state().bodies[0].pose.position.norm();
}

}  // namespace mrhi::testing
