#pragma once

#include <string>

#include "support/fixtures.h"

namespace mrhi::testing {

/// A rod of one length, which hangs by one end; its body frame is in its middle, along -z.
struct Rod {
  double length = 0.3;  // [m]
  double mass = 0.2;    // [kg]
  double width = 0.02;  // [m]
  Body body(const std::string& name) const {
    Body rod = box_body({width, width, length}, mass);
    rod.name = name;
    return rod;
  }
  Pose top() const { return {{0, 0, 0.5 * length}, Quaternion::Identity()}; }
  Pose bottom() const { return {{0, 0, -0.5 * length}, Quaternion::Identity()}; }
  double inertia_about_end() const { return mass * (4.0 * length * length + width * width) / 12.0; }
};

inline Joint hinge(int parent, int child, const Pose& in_parent, const Pose& in_child, double start = 0.0) {
  Joint joint;
  joint.name = "joint_" + std::to_string(child);
  joint.parent = parent;
  joint.child = child;
  joint.axis = Vector3::UnitY();
  joint.in_parent = in_parent;
  joint.in_child = in_child;
  joint.start = start;
  return joint;
}

/// So many rods, one below the other, on the world.
inline Scene pendulum(int rods, double start, double gravity, double ratio = 1.0) {
  Scene scene;
  scene.name = "pendulum";
  scene.gravity = {0, 0, -gravity};
  Rod rod;
  for (int i = 0; i < rods; ++i) {
    scene.bodies.push_back(rod.body("rod_" + std::to_string(i)));
    const Pose above = i == 0 ? Pose{{0, 0, 0.5}, Quaternion::Identity()} : rod.bottom();
    scene.joints.push_back(hinge(i - 1, i, above, rod.top(), i == 0 ? start : 0.0));
    rod.mass *= ratio;
  }
  return scene;
}

inline double energy(const Simulation& simulation) {
  double sum = 0.0;
  const Scene& scene = simulation.scene();
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const BodyState& state = simulation.state().bodies[b];
    sum += kinetic_energy(scene.bodies[b], state) -
           scene.bodies[b].mass * scene.gravity.dot(state.pose.position);
  }
  return sum;
}

inline Vector3 angular_momentum(const Simulation& simulation) {
  Vector3 sum = Vector3::Zero();
  for (const BodyState& state : simulation.state().bodies)
    sum += state.angular_momentum + state.pose.position.cross(state.linear_momentum);
  return sum;
}

/// By how much a joint has come apart: where its two frames are in world, as poses of the bodies have them.
struct Apart {
  double place = 0.0;  // across what the joint lets go [m]
  double turn = 0.0;   // likewise [rad]
};
inline Apart apart(const Simulation& simulation, std::size_t index) {
  const Joint& joint = simulation.scene().joints[index];
  const auto& bodies = simulation.state().bodies;
  const Pose parent = joint.parent < 0 ? Pose() : bodies[static_cast<std::size_t>(joint.parent)].pose;
  const Pose on_parent =
      parent * joint.in_parent * joint_motion(joint, simulation.state().joints[index].position);
  const Pose on_child = bodies[static_cast<std::size_t>(joint.child)].pose * joint.in_child;
  return {(on_parent.position - on_child.position).norm(),
          on_parent.orientation.angularDistance(on_child.orientation)};
}

/// Frames without hands.
inline void let_go_on(Simulation& simulation, double from, double to, double rate,
                      const std::function<void(const Simulation&)>& each = nullptr) {
  const auto frames = static_cast<long>(std::llround((to - from) * rate));
  for (long i = 0; i <= frames; ++i) {
    simulation.advance({at(from + static_cast<double>(i) / rate), {}});
    if (each) each(simulation);
  }
}

}  // namespace mrhi::testing
