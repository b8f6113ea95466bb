#pragma once

#include <stdexcept>
#include <vector>

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// Points from which no pose can be told. what() is one line.
class FitError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The same point in a local frame and in world [m].
struct PointPair {
  Vector3 local, world;
};

struct RigidFit {
  Pose local_in_world;
  std::vector<double> residuals;  ///< distance of each pair's points once both are in world [m]
  double rms = 0.0;               ///< of the residuals [m]
};

/// The pose that brings the local points nearest to those in world, by least squares and without scale
/// (Umeyama 1991). Throws FitError for fewer than three points, points that are not finite, within 1 cm (rms)
/// of one line, or mirrored. Points in one plane fit their mirror image as well as themselves: only points
/// off it can show a left-handed frame.
RigidFit fit_rigid(const std::vector<PointPair>& pairs);

}  // namespace mrhi
