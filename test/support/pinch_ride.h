#pragma once

#include "support/pinch_scene.h"

namespace mrhi::testing {

constexpr double kRideFrom = 1.0;  // [s]
constexpr double kRideFor = 10.0;  // [s]

/// Where the cube sits in the hand.
struct Seat {
  Vector3 position;
  Quaternion orientation;
};

struct Ride {
  double true_slip = 0.0;     // after the motion against before [m]
  double true_turn = 0.0;     // [rad]
  double displacement = 0.0;  // largest while moving [m]
  double jitter = 0.0;        // rms of the cube's speed while the hand is still again, times a step [m]
  double push = 0.0;          // sum of the normal forces at rest [N]
  double overlap = 0.0;       // sum of depths times shares at rest [m]
};

inline Ride ride(const PinchScene& pinch, const Configuration& configuration, double rate,
                 const std::function<Vector3(double)>& sway) {
  Simulation simulation(pinch.scene(), configuration);
  const auto sway_at = [&](double t) -> Vector3 {
    return t < kRideFrom || t >= kRideFrom + kRideFor ? Vector3::Zero() : sway(t - kRideFrom);
  };
  const auto seat = [&](double t) {
    const BodyState& state = simulation.state().bodies[0];
    return Seat{state.pose.position - sway_at(t), state.pose.orientation};
  };
  const auto advance = [&](double t) { simulation.advance({at(t), {pinch.hand(t, sway_at(t))}}); };
  int frame = 0;
  for (; frame / rate < kRideFrom; ++frame) advance(frame / rate);
  const Seat before = seat(0.0);
  Ride result;
  for (const Contact& contact : simulation.state().contacts) {
    result.push -= contact.normal.dot(contact.force);
    if (contact.touching()) result.overlap += contact.share * contact.depth;
  }
  for (; frame / rate < kRideFrom + kRideFor; ++frame) {
    advance(frame / rate);
    result.displacement =
        std::max(result.displacement, (seat(frame / rate).position - before.position).norm());
  }
  for (; frame / rate < kRideFrom + kRideFor + 2.0; ++frame) advance(frame / rate);
  const Seat after = seat(0.0);
  result.true_slip = (after.position - before.position).norm();
  result.true_turn = after.orientation.angularDistance(before.orientation);
  result.jitter = object_twist(simulation).linear.norm() * configuration.step;
  return result;
}

/// Ends softly, so that the motion has no blow in it that scene (a) does not have.
inline std::function<Vector3(double)> eased(double amplitude, double frequency) {
  return [=](double t) -> Vector3 {
    return smooth(t, 1.0) * (1.0 - smooth(t - kRideFor + 1.0, 1.0)) * swing(t, amplitude, frequency);
  };
}

}  // namespace mrhi::testing
