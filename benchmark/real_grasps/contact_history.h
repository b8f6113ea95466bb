#pragma once

#include <optional>
#include <vector>

#include "mr_hand_interaction/simulation.h"

namespace mrhi::real_grasps {

/// Action of a hand that first moves a body.
enum class MotionCause {
  back,     ///< impact with the back of the hand or of a finger
  sweep,    ///< motion of the whole hand against the body
  closing,  ///< a finger closed on the body
  open      ///< contact with fingers that stayed open or opened
};
const char* to_string(MotionCause cause);

struct FirstMotion {
  double time;  ///< [s]
  MotionCause cause;
};

/// Action on a body at rest in a frame of `seconds` [s] after which it moves faster than 0.03 m/s; else
/// empty.
std::optional<FirstMotion> first_motion(const Simulation& simulation, int body, double seconds);

/// Appends the force of each loaded finger or palm at the end of the frame [N]: the sum of its contacts'
/// forces. Excludes contacts with an impact in the frame, whose load is unknown.
void add_finger_forces(const FrameResult& result, std::vector<double>& forces);

}  // namespace mrhi::real_grasps
