#pragma once

#include <functional>
#include <vector>

#include "mr_hand_interaction/scene/scene.h"
#include "mr_hand_interaction/simulation.h"

namespace mrhi::crowds {

/// A scene of many bodies, with the hands that act on it.
struct Crowd {
  std::string name;
  Scene scene;
  double seconds;            // duration
  double frame = 0.001;      // period of input [s]
  bool sleep = true;         // bodies at rest may sleep
  bool whole_frame = false;  // timed from the frame's arrival to the rendered hands; false: by the step
  std::function<std::vector<Hand>(double t)> hands = [](double) { return std::vector<Hand>(); };
};

/// Cubes in random orientations, dropped from a hand's breadth above a floor.
Crowd dropped(int count, double edge, const char* name);
/// Cubes at rest on a floor and on each other, with gaps sideways [m].
Crowd block(int count, double gap = 2e-5);
/// Equal boxes, each half inside the next.
Crowd overlapping(int count);
Crowd far_spinning(int count);
/// The same in frames of 1/120 s, which are divided into steps because a hand holds a cube.
Crowd far_from_a_grasp(int count);
/// A hand sweeps blocks along a table.
Crowd pushed(int count);
/// Boxes half a millimetre apart on a table: one hand lifts one, the other is at rest beside them.
Crowd lifted(int count);

/// Scenes of the table, in order.
std::vector<Crowd> all_crowds();

/// Drops increasing numbers of cubes on a floor. Prints, as CSV, the cost of a large island's step and its
/// velocity error against the converged solution of the same problem.
void print_cut_short();

}  // namespace mrhi::crowds
