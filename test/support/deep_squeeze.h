#pragma once

#include <ostream>
#include <string>

#include "support/grips.h"

namespace mrhi::testing {

constexpr double kDeep = 0.015;  // [m] into each side
constexpr double kMissed =
    0.0001;  // by which the two fingertips are off each other's line, as any two are [m]

const Vector3 kCarried(0.05, 0.1, 0.05);  // [m]
constexpr double kSqueezedMass = 0.05;    // [kg]

/// An object squeezed by two fingers from 0 to 0.5 s, carried away from 1 to 2 s.
struct Squeeze {
  std::string name;
  Vector3 size;  // of the object; squeezed along x
  bool flat;     // fingers lie along the faces instead of standing on their tips

  Hand hand(double t) const {
    const double x = 0.5 * size.x() + 0.01 - (0.01 + kDeep) * smooth(t, 0.5);
    Hand hand = empty_hand();
    for (const int finger : {0, 1}) {
      const Vector3 outward(finger == 0 ? -1.0 : 1.0, 0.0, 0.0);
      const int capsule = capsule_index(finger, 3);
      const Vector3 point = x * outward + 0.5 * kMissed * outward.x() * Vector3(0, 0.6, 0.8);
      if (flat) add_flat_finger(hand, capsule, point, outward, Vector3::UnitY());
      if (!flat) add_fingertip(hand, capsule, point, outward);
    }
    Pose way;
    way.position = smooth(t - 1.0, 1.0) * kCarried;
    return moved(hand, way);
  }
};

inline void PrintTo(const Squeeze& squeeze, std::ostream* out) {
  *out << squeeze.name;
}

struct Squeezed {
  double off = 0.0;     // from where the hand has brought it [m]
  double turned = 0.0;  // largest turn [rad]
};

inline Squeezed squeeze_and_carry(const Squeeze& squeeze, const Configuration& configuration) {
  Simulation simulation(scene_of(stiff_box(squeeze.size, kSqueezedMass)), configuration);
  Squeezed squeezed;
  play(
      simulation, 0.0, 4.0, 120.0, [&](double t) { return squeeze.hand(t); },
      [&](const Simulation& s) {
        const Quaternion& orientation = s.state().bodies[0].pose.orientation;
        squeezed.turned = std::max(squeezed.turned, orientation.angularDistance(Quaternion::Identity()));
      });
  squeezed.off = (simulation.state().bodies[0].pose.position - kCarried).norm();
  return squeezed;
}

}  // namespace mrhi::testing
