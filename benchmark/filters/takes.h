#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mr_hand_interaction/configuration.h"
#include "mr_hand_interaction/tracking/hand.h"

namespace mrhi::filter_benchmark {

/// Paths over time: a row for each frame, three columns for each point.
using Paths = Eigen::MatrixXd;

struct Smoothed {
  Paths positions, velocities;
};

/// Smooths without delay: fits a parabola at every frame to the points within `half_width` seconds, by least
/// squares with tricube weights (Cleveland 1979). The half-power frequency is 0.7 / half_width Hz at any
/// frame rate.
Smoothed smoothed(const std::vector<double>& times, const Paths& paths, double half_width);

/// Motion of a hand's joint at a frame.
enum class Doing : char { still, moving, neither };

/// Ends of phalanges that a hand has throughout a take: its joints, including its fingertips.
struct Joints {
  std::vector<std::size_t> capsules;
  std::vector<std::size_t> tips;                           ///< indices in `capsules`
  std::vector<std::pair<std::size_t, std::size_t>> bones;  ///< indices in `capsules` of a bone's two ends
};

/// A part of a recording in which one hand is tracked without interruption.
struct Take {
  std::vector<double> times;  ///< [s]
  std::vector<Hand> input;    ///< input of the filter
  Joints joints;
  Paths reference;                        ///< true positions of the joints
  std::vector<std::vector<Doing>> doing;  ///< by joint, then by frame

  double frame_rate() const;  ///< from the median interval [1/s]
};

/// Takes of all recordings. The reference is the recording smoothed without delay; with added noise, it is
/// the recording itself.
std::vector<Take> load_takes(const std::vector<std::string>& files, bool with_noise);

/// Joints of a take's hands.
Paths paths_of(const std::vector<Hand>& hands, const Joints& joints);

}  // namespace mrhi::filter_benchmark
