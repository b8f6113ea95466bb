#pragma once

#include "support/grips.h"

namespace mrhi::testing {

const Vector3 kBar(0.02, 0.2, 0.02);    // [m]
constexpr double kBarMass = 0.05;       // [kg]
constexpr double kEndOverlap = 0.004;   // of each fingertip [m]
constexpr double kFromEnd = 0.01;       // fingertips to the bar's end [m]
const double kSlant = 45.0 * kDegrees;  // of the fingers against the finger line

/// Two slanted fingertips close on one end of a bar along y; the finger line is x.
inline Hand closing_on_the_end(double t) {
  const double x = 0.5 * kBar.x() + closing_gap(t, kEndOverlap);
  Hand hand = empty_hand();
  const double y = -0.5 * kBar.y() + kFromEnd;
  for (const int finger : {0, 1}) {
    const Vector3 outward(finger == 0 ? -1.0 : 1.0, 0.0, 0.0);
    add_fingertip(hand, capsule_index(finger, 3), x * outward + Vector3(0, y, 0), outward, kSlant);
  }
  return hand;
}

/// Turned by a quarter about the vertical axis and about the finger line in 0.8 s each, then shaken across
/// the bar by 2 cm at 2 Hz.
inline Pose turned_and_shaken(double t) {
  const double quarter = 90.0 * kDegrees;
  Pose pose;
  pose.orientation = Eigen::AngleAxisd(quarter * smooth(t - 2.0, 0.8), Vector3::UnitX()) *
                     Eigen::AngleAxisd(quarter * smooth(t - 1.0, 0.8), Vector3::UnitZ());
  const double ease = smooth(t - 3.0, 0.5) * (1.0 - smooth(t - 5.0, 0.5));
  const double shake = ease * 0.02 * std::sin(2.0 * M_PI * 2.0 * (t - 3.0));
  pose.position = shake * Vector3(1, 1, 1).normalized();
  return pose;
}

struct Swing {
  double largest = 0.0, after = 0.0;  // turn of the bar about the finger line against the hand [rad]
  bool held = false;
};

inline Swing swing_about_finger_line(const Configuration& configuration) {
  Simulation simulation(scene_of(stiff_box(kBar, kBarMass)), configuration);
  Swing swing;
  Quaternion hand_orientation = Quaternion::Identity();
  play(
      simulation, 0.0, 6.0, 120.0,
      [&](double t) {
        const Pose pose = turned_and_shaken(t);
        hand_orientation = pose.orientation;
        return moved(closing_on_the_end(t), pose);
      },
      [&](const Simulation& s) {
        const Quaternion turn = hand_orientation.conjugate() * s.state().bodies[0].pose.orientation;
        swing.after = std::abs(2.0 * std::atan2(turn.x(), turn.w()));
        swing.largest = std::max(swing.largest, swing.after);
      });
  swing.held = simulation.state().interactions[0].level == InteractionLevel::grasp;
  return swing;
}

}  // namespace mrhi::testing
