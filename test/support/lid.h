#pragma once

#include "support/joints.h"

namespace mrhi::testing {

/// A lid, hinged along y at the origin, that lies along x and opens upwards, and two fingers that pinch its
/// rim from above and below and carry it along its arc.
struct Lid {
  double length = 0.2, thickness = 0.01, mass = 0.5;  // [m], [m], [kg]
  double stiffness = 2000.0;                          // [N/m]
  double overlap = 0.002;                             // of each fingertip [m]
  double gravity = 0.0;                               // [m/s^2]
  double radius = 0.008;                              // of a finger [m]
  double at = 0.18;                                   // of the fingers, from the hinge [m]

  Scene scene() const {
    Scene scene;
    scene.name = "lid";
    scene.gravity = {0, 0, -gravity};
    Body lid = box_body({length, 0.2, thickness}, mass);
    lid.name = "lid";
    lid.material.stiffness = stiffness;
    scene.bodies.push_back(lid);
    Joint joint = hinge(Joint::kWorld, 0, {}, {{-0.5 * length, 0, 0}, Quaternion::Identity()});
    joint.axis = -Vector3::UnitY();
    scene.joints.push_back(joint);
    return scene;
  }

  /// With the lid at `angle`, closed in on it as far as `closed` says (0..1).
  Hand hand(double angle, double closed) const {
    const Quaternion turn(Eigen::AngleAxisd(-angle, Vector3::UnitY()));
    const double off = 0.5 * thickness + radius + (1.0 - closed) * 0.01 - closed * overlap;
    Hand result;
    result.id = 1;
    const Vector3 along(0, 0.0125, 0);
    for (const int side : {1, -1}) {
      const Vector3 place = turn * Vector3(at, 0, side * off);
      add_finger(result, capsule_index(side > 0 ? 1 : 0, 3), place - along, place + along, radius);
    }
    result.palm = {turn * Vector3(at + 0.08, 0, 0), turn};
    return result;
  }
};

}  // namespace mrhi::testing
