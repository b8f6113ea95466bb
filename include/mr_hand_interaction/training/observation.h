#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/simulation.h"

namespace mrhi {

/// What a trial sees of its object at one time.
struct Observation {
  Nanoseconds stamp = 0;
  Pose pose;                         ///< of the object's body frame in world
  Twist twist;                       ///< world axes
  bool held = false;                 ///< grasped by a hand
  bool touched = false;              ///< by a hand
  std::optional<double> grip_force;  ///< half the sum of the forces that press on the object [N]
  int tracking_losses = 0;           ///< hands lost since the observation before
  bool put_back = false;             ///< left the bounds since then, and was put back where it started
  std::vector<std::pair<std::string, double>> joints;  ///< by name: where it is [rad], [m]
};

/// Of a body of a simulation and what hangs on it, after a frame.
Observation observe(const Simulation& simulation, std::size_t body);

}  // namespace mrhi
