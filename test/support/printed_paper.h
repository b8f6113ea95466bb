#pragma once

#include <algorithm>

#include "support/fixtures.h"

namespace mrhi::testing {

/// How far Eq. 1 as printed puts a still hand from the origin, over where it is, at F = 3.
constexpr double kPrintedGain = 4.0 / 3.0;

/// The paper's 100 N/m, and a cube so heavy to turn that it does not: Eqs. 16 to 20 without moments.
struct DraggedCube {
  static constexpr double kHalf = 0.025, kRadius = 0.008;   // of the cube, of the fingers [m]
  static constexpr double kMass = 0.1, kStiffness = 100.0;  // [kg], [N/m]

  static Body body() {
    Body body = box_body(Vector3::Constant(2.0 * kHalf), kMass);
    body.inertia *= 1e9;
    body.material.stiffness = kStiffness;
    return body;
  }

  /// Two fingers along y that press the cube from both sides along z, each with its centroid `depth` deep,
  /// and then drag it along x by 6 cm. `gain`: of the filter, which is undone.
  static Hand hand(double t, double depth, double gain) {
    const auto smooth = [](double u) {
      const double s = std::clamp(u, 0.0, 1.0);
      return s * s * (3.0 - 2.0 * s);
    };
    const double z = kHalf + 0.02 - (0.02 + depth) * smooth(t / 0.5), x = 0.06 * smooth((t - 0.6) / 0.3);
    Hand hand;
    for (const double side : {1.0, -1.0}) {
      const Vector3 middle = Vector3(x, 0.0, side * z) / gain, along(0.0, 0.005 / gain, 0.0);
      add_finger(hand, capsule_index(side > 0.0 ? 1 : 0, 3), middle - along, middle + along, kRadius);
    }
    hand.palm.position = Vector3(x, 0.0, -0.2) / gain;
    hand.id = 1;
    return hand;
  }
};

}  // namespace mrhi::testing
