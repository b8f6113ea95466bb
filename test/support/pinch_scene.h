#pragma once

#include <algorithm>
#include <cmath>

#include "support/fixtures.h"

namespace mrhi::testing {

/// Minimum-jerk way from 0 to 1 within `duration` [s] (Flash & Hogan 1985).
inline double smooth(double t, double duration) {
  const double x = std::clamp(t / duration, 0.0, 1.0);
  return x * x * x * (10.0 + x * (-15.0 + 6.0 * x));
}

/// Scene (a): 20 capsules of radius 8 mm and 25 mm segment, four fingers of four and a thumb of four; the
/// four distal finger capsules and the thumb's press a free 50 mm cube of 0.1 kg, 2 mm beyond its surface,
/// closing in 0.2 s. The whole hand is moved by `sway(t)` from 0.5 s on.
struct PinchScene {
  double stiffness = 2000.0;  // [N/m]
  double overlap = 0.002;     // [m]
  double mass = 0.1;          // [kg]
  double radius = 0.008;
  double half = 0.025;
  double finger_spacing = 0.0125;

  Scene scene() const {
    Body cube = box_body(Vector3::Constant(2.0 * half), mass);
    cube.material.stiffness = stiffness;
    return scene_of(cube);
  }

  Hand hand(double t, const Vector3& sway) const {
    const double gap = 0.01 - (0.01 + overlap) * smooth(t, 0.2);
    Hand result;
    result.id = 1;
    result.palm.position = sway + Vector3(0, 0, -0.08);
    for (int finger = 0; finger < kFingers; ++finger) {
      const double side = finger == 0 ? -1.0 : 1.0;
      const double x = side * (half + radius + gap);
      const double y = finger == 0 ? 0.0 : (finger - 2.5) * finger_spacing;
      // The distal capsule lies along the face; the others lead away from the cube and do not touch it.
      Vector3 end = sway + Vector3(x, y, 0.0125);
      for (int bone = kBonesPerFinger - 1; bone >= 0; --bone) {
        const Vector3 start = end - (bone == 3 ? Vector3(0, 0, 0.025) : Vector3(-side * 0.018, 0, 0.017));
        add_finger(result, capsule_index(finger, bone), start, end, radius);
        end = start + Vector3(side * 0.004, 0, 0);
      }
    }
    return result;
  }
};

inline Vector3 swing(double t, double amplitude, double frequency) {
  return amplitude * std::sin(2.0 * M_PI * frequency * t) * Vector3(1, 2, 2) / 3.0;
}

}  // namespace mrhi::testing
