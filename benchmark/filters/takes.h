#pragma once

#include <string>
#include <vector>

#include "mr_hand_interaction/configuration.h"
#include "mr_hand_interaction/tracking/hand.h"
#include "smoother.h"

namespace mrhi::filter_benchmark {

/// What a hand's joint does at a frame.
enum class Doing : char { still, moving, neither };

/// The ends of phalanges that a hand has throughout a take: its joints, and its fingertips among them.
struct Joints {
  std::vector<std::size_t> capsules;
  std::vector<std::size_t> tips;                           ///< positions in `capsules`
  std::vector<std::pair<std::size_t, std::size_t>> bones;  ///< positions in `capsules` of a bone's two ends
};

/// One hand of a recording as long as it is tracked without a break.
struct Take {
  std::vector<double> times;  ///< [s]
  std::vector<Hand> input;    ///< what a filter is given
  Joints joints;
  Paths reference;                        ///< where the joints are
  std::vector<std::vector<Doing>> doing;  ///< by joint, then by frame

  double frame_rate() const;  ///< the middle one of its intervals' [1/s]
};

/// The takes of all recordings. As recorded, the reference is the recording smoothed without delay; with
/// noise added, it is the recording itself.
std::vector<Take> load_takes(const std::vector<std::string>& files, bool with_noise);

/// Joints of a take's hands.
Paths paths_of(const std::vector<Hand>& hands, const Joints& joints);

}  // namespace mrhi::filter_benchmark
