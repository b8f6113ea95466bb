#pragma once

#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mr_hand_interaction/configuration.h"
#include "mr_hand_interaction/scene/scene.h"
#include "mr_hand_interaction/tracking/joints.h"
#include "statistics.h"

namespace mrhi::real_grasps {

/// Of a window: the recording that it was cut from, whose hands, and what they hold.
struct WindowLabels {
  std::string capture, person, object;
};

/// Captured hands and object, as cut by import_captures.
struct Window {
  std::string name;
  WindowLabels labels;
  Scene scene;                      ///< the object alone, at 1 g: a body, or two on a hinge
  std::vector<JointsFrame> frames;  ///< as seen by a device at the default mount
  std::vector<Pose> places;         ///< of the object's body, or of the parent of two, in each frame
  std::vector<double> angles;       ///< of its hinge, if any, likewise [rad]
  std::size_t free_from = 0;        ///< frame at which it is released
};

/// Throws RecordingError, SceneError.
std::vector<Window> load_windows(const std::string& folder, const Configuration& configuration);

/// Motion of the object from the frame after its release.
struct WindowOutcome {
  std::vector<double> away;    ///< distance from its captured position, in each frame [m]
  std::vector<double> turned;  ///< error of its hinge, likewise [rad]
  std::vector<double> forces;  ///< of each loaded finger, in each frame [N]
  WindowLabels labels;
};

/// Last frame before the release in which no hand touches the object; 0 if there is none.
std::size_t last_clear(const Window& window, const Configuration& configuration);

/// Drives the object along its captured path before its window: for up to `lead` seconds, or without `lead`
/// from last_clear() on. So hands acquire their contacts as they approach. Then releases it with its captured
/// velocity.
WindowOutcome play(const Window& window, const Configuration& configuration, std::optional<double> lead);

/// Rigid baseline: the object keeps its pose relative to the distal phalanges (least squares) of the better
/// hand in hindsight. No finger moves in this hand, and nothing slips or falls.
WindowOutcome play_rigidly(const Window& window);

/// Fraction of all frames with an error below `limit` [m], and below `angle` [rad] at the hinge, if any.
double fraction_within(const std::vector<WindowOutcome>& outcomes, double limit,
                       double angle = std::numeric_limits<double>::infinity());

/// Its interval at 95 % confidence: the bootstrap over captures.
Interval fraction_interval(const std::vector<WindowOutcome>& outcomes, double limit);

/// The same of the difference between two outcomes of each window: `outcomes` less `baseline`. There may be
/// several of the first for each of the second.
Interval difference_interval(const std::vector<WindowOutcome>& outcomes,
                             const std::vector<WindowOutcome>& baseline, double limit);

/// Outcomes by a label, in the order of its values.
std::map<std::string, std::vector<WindowOutcome>> by_label(const std::vector<WindowOutcome>& outcomes,
                                                           std::string WindowLabels::*label);

/// Number of windows in which this holds for every frame.
std::size_t stayed(const std::vector<WindowOutcome>& outcomes, double limit);

/// 90th percentile of all finger forces [N].
double force_p90(const std::vector<WindowOutcome>& outcomes);

}  // namespace mrhi::real_grasps
