#pragma once

#include "support/pinch_scene.h"

namespace mrhi::testing {

/// The hand with its four fingers displaced, while the thumb and the palm stay.
inline Hand with_fingers_moved(Hand hand, const Vector3& displacement) {
  for (int finger = 1; finger < kFingers; ++finger) {
    for (int bone = 0; bone < kBonesPerFinger; ++bone) {
      Capsule& capsule = hand.capsules[static_cast<std::size_t>(capsule_index(finger, bone))];
      capsule.start += displacement, capsule.end += displacement;
    }
  }
  return hand;
}

/// Speed of the cube of scene (a) once the four fingers have left it at 2 m/s while the thumb stays [m/s].
/// The thumb is pressed `overlap` into it: a spring that gives back all its energy pushes at overlap sqrt(k /
/// m).
inline double speed_as_one_side_leaves(const Configuration& configuration, double overlap = 0.005) {
  constexpr double kLeave = 1.0, kSpeed = 2.0, kRate = 1000.0;  // [s], [m/s], [Hz]
  PinchScene pinch;
  pinch.overlap = overlap;
  Scene scene = pinch.scene();
  if (configuration.stiffness) scene.bodies[0].material.stiffness = *configuration.stiffness;
  Simulation simulation(scene, configuration);
  play(simulation, 0.0, kLeave + 0.2, kRate, [&](double t) {
    return with_fingers_moved(pinch.hand(t, Vector3::Zero()),
                              Vector3(kSpeed * std::max(0.0, t - kLeave), 0, 0));
  });
  return object_twist(simulation).linear.norm();
}

}  // namespace mrhi::testing
