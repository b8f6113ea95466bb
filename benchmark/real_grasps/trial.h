#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "closing.h"
#include "contact_history.h"
#include "mr_hand_interaction/configuration.h"
#include "mr_hand_interaction/scene/body.h"

namespace mrhi::real_grasps {

/// State of the body at the end of a frame.
struct Moment {
  double time;  ///< [s]
  Vector3 place, velocity;
  bool loaded = false;  ///< true if any finger or the palm is loaded
};

/// Record of one body in one hand.
struct Playback {
  std::vector<Moment> moments;
  std::vector<double> forces;                      ///< of each loaded finger, in each frame [N]
  std::vector<double> frame_times;                 ///< cost of each frame [us]
  std::optional<double> grasp_began, grasp_ended;  ///< first of each [s]
  bool has_grasps = false;                         ///< the engine reports grasps
  bool assisted = false;                           ///< contact/grasp_assist was active
  std::optional<FirstMotion> first_motion;         ///< its first motion; our engine only
};

/// Outcome of a body placed where a hand closes. Times are the recording's [s].
struct Outcome {
  bool held = false;      ///< grasped, not lost, and in the hand in the last frame before it opens
  bool carried = false;   ///< in the hand in that frame, and loaded until shortly before; engines that report
                          ///< no grasps use this for `held`
  bool assisted = false;  ///< grasp assist was active
  std::optional<FirstMotion> first_motion;  ///< its first motion
  double away = 0.0;                        ///< distance from the grip, in that frame [m]
  double early = 1.0;                       ///< displacement before the hand had closed [m]
  double force = 0.0;  ///< 90th percentile of a finger's force during contact [N]; 0: no contact
  double speed = 0.0;  ///< largest speed of the body, over that of the hand's fastest joint
  std::optional<double> grasp_began, grasp_ended;  ///< first begin and first end
  std::optional<double> released;                  ///< time of the first frame without contact after opening
  double release = 0.0;                            ///< speed relative to the palm at that time [m/s]
  std::vector<double> frame_times;                 ///< [us]
  std::string note;                                ///< reason why it could not be run, or empty
};

/// Largest displacement before closing at which the hand, not the open loop, decides the outcome [m].
constexpr double kFair = 0.010;

/// A homogeneous body at rest.
Body body_of(const Row& row, const Pose& place, const Material& material);

Outcome outcome_of(const Playback& playback, const Track& track, const Closing& closing, const Row& row);

/// Plays the recorded frames, seen by the default device mount, with the body at its place.
using Player = std::function<Playback(const std::vector<JointsFrame>&, const Closing&, const Row&)>;

/// Plays a closing from its first frame to its last. An exception of the player becomes the note.
Outcome play(const Recording& recording, const Closing& closing, const Row& row,
             const Disturbance& disturbance, const Player& player);

/// Plays in our engine.
Playback play_ours(const std::vector<JointsFrame>& frames, const Closing& closing, const Row& row,
                   const Configuration& configuration);

}  // namespace mrhi::real_grasps
