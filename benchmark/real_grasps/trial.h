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

/// The body as a frame ends.
struct Moment {
  double time;  ///< [s]
  Vector3 place, velocity;
  bool pressed = false;  ///< by any finger or the palm
};

/// All that is seen of one body in one hand.
struct Story {
  std::vector<Moment> moments;
  std::vector<double> forces;                      ///< of each finger that presses, in each frame [N]
  std::vector<double> frame_times;                 ///< what each frame cost [us]
  std::optional<double> grasp_began, grasp_ended;  ///< first of each [s]
  bool has_grasps = false;                         ///< the engine knows what a grasp is
  bool taken = false;                              ///< contact/grasp_assist bore the body
  std::optional<FirstBlow> blow;                   ///< what first set it in motion; ours alone
};

/// What became of a body that was put where a hand closes. Times are the recording's [s].
struct Outcome {
  bool held = false;     ///< grasped, not lost, and in the hand in the last frame before it opens
  bool carried = false;  ///< in the hand in that frame, and pressed until shortly before: also told of
                         ///< engines that do not know what a grasp is, for which `held` is this
  bool taken = false;    ///< help bore it
  std::optional<FirstBlow> blow;  ///< what first set it in motion
  double away = 0.0;              ///< of the body from the grip, in that frame [m]
  double early = 1.0;             ///< by how much it had been nudged as the hand closed [m]
  double force = 0.0;  ///< of a finger while it presses, nine frames of ten at most [N]; 0: no touch
  double speed = 0.0;  ///< of the body at its fastest, over the hand's fastest joint's
  std::optional<double> grasp_began, grasp_ended;  ///< first begin; first end
  std::optional<double> let_go;                    ///< time of the first frame without touch after it opened
  double release = 0.0;                            ///< then, of the body against the palm [m/s]
  std::vector<double> frame_times;                 ///< [us]
  std::string note;                                ///< why it could not be run, or empty
};

/// Of those that were nudged less than this the hand, and not the open loop, decides [m].
constexpr double kFair = 0.010;

/// A homogeneous body at rest.
Body body_of(const Row& row, const Pose& place, const Material& material);

Outcome outcome_of(const Story& story, const Track& track, const Closing& closing, const Row& row);

/// Plays the recorded frames, as the default device mount has them, with the body at its place.
using Player = std::function<Story(const std::vector<JointsFrame>&, const Closing&, const Row&)>;

/// From the closing's first frame to its last. What the player throws becomes the note.
Outcome play(const Recording& recording, const Closing& closing, const Row& row,
             const Disturbance& disturbance, const Player& player);

/// In the core.
Story play_ours(const std::vector<JointsFrame>& frames, const Closing& closing, const Row& row,
                const Configuration& configuration);

}  // namespace mrhi::real_grasps
