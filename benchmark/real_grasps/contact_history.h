#pragma once

#include <optional>
#include <vector>

#include "mr_hand_interaction/simulation.h"

namespace mrhi::real_grasps {

/// What a hand did as it first set a body in motion.
enum class Blow {
  back,     ///< struck it with its back, or with the back of a finger
  sweep,    ///< moved against it as a whole
  closing,  ///< closed a finger on it
  open      ///< touched it with fingers that stayed or opened
};
const char* to_string(Blow blow);

struct FirstBlow {
  double time;  ///< [s]
  Blow blow;
};

/// That of a body at rest, once a frame of `seconds` [s] has given it more than 0.03 m/s; else nothing.
std::optional<FirstBlow> first_blow(const Simulation& simulation, int body, double seconds);

/// Adds, of each finger or palm that presses as the frame ends, how hard [N]: the sum of its contacts'
/// forces. Contacts struck in the frame are left out: what they are pressed with is not known.
void add_finger_forces(const FrameResult& result, std::vector<double>& forces);

}  // namespace mrhi::real_grasps
