#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "mr_hand_interaction/configuration.h"
#include "mr_hand_interaction/scene/scene.h"
#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi::real_grasps {

/// Captured hands on a captured object, as arctic_windows.py cuts them.
struct Window {
  std::string name;
  bool first = false;               ///< of its capture
  Scene scene;                      ///< the object alone, at 1 g: a body, or two on a hinge
  std::vector<JointsFrame> frames;  ///< as a device at the default mount sees the hands
  std::vector<Pose> places;    ///< of the object's body, of two that which carries the other, in each frame
  std::vector<double> angles;  ///< of its hinge, likewise, if it has one [rad]
  std::size_t free_from = 0;   ///< frame in which it is let free
};

/// Throws RecordingError, SceneError.
std::vector<Window> load_windows(const std::string& folder, const Configuration& configuration);

/// What became of the object, from the frame after it was let free.
struct WindowOutcome {
  std::vector<double> away;    ///< from where it was recorded, in each frame [m]
  std::vector<double> turned;  ///< its hinge, from what was recorded, likewise [rad]
  std::vector<double> forces;  ///< of each finger that presses, in each frame [N]
};

/// Last frame before the object is let free in which no hand touches it; 0 if there is none.
std::size_t last_clear(const Window& window, const Configuration& configuration);

/// For up to `lead` seconds [s] before its window, or without `lead` from last_clear() on, the object is led
/// where it was recorded, so that hands touch it as they come to it; then it is free, with the velocity
/// recorded.
WindowOutcome play(const Window& window, const Configuration& configuration, std::optional<double> lead);

/// What a hand that carried the object as if it were one with it would do: the object keeps its pose in the
/// last phalanges (least squares) of the hand that is best in hindsight. No fingers move in it, nothing slips
/// or falls.
WindowOutcome play_rigidly(const Window& window);

/// Share of all frames in which the object is less than `limit` [m] from its recorded place, and its hinge,
/// if it has one, less than `angle` [rad] from where it was recorded.
double share_within(const std::vector<WindowOutcome>& outcomes, double limit,
                    double angle = std::numeric_limits<double>::infinity());

/// Windows in which it is so in every frame.
std::size_t stayed(const std::vector<WindowOutcome>& outcomes, double limit);

/// That nine of ten of all finger forces do not exceed [N].
double force_p90(const std::vector<WindowOutcome>& outcomes);

}  // namespace mrhi::real_grasps
