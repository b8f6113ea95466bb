#pragma once

#include <vector>

#include "mr_hand_interaction/synthetic/hand_skeleton.h"

namespace mrhi {

struct Reach {
  FingerAngles angles;
  double error;  ///< distance that remains between tip and target [m]
};

/// Angles within the limits that bring the end of the last bone to `target` (right hand's frame), as near to
/// `preferred` as that allows: damped least squares with the preference in the null space (Nakamura &
/// Hanafusa 1986).
Reach reach(const FingerSkeleton& finger, const Vector3& target, const FingerAngles& preferred);

/// Where a fingertip is to touch an object: a point of its surface and the outward normal there.
struct FingertipContact {
  int finger;
  Vector3 point;
  Vector3 normal;
  double depth;  ///< how far the tip is to press beyond the surface [m]
};

/// `preferred` with the fingers of `contacts` placed so that their tips, as spheres of the finger's radius,
/// are `gap` off the surface, or at each contact's depth if gap is negative. Contacts in the frame that
/// `wrist` is in; right hand. `worst_error`, if given, becomes the largest Reach::error.
HandPosture place_fingertips(const HandSkeleton& skeleton, const Pose& wrist,
                             const std::vector<FingertipContact>& contacts, double gap,
                             const HandPosture& preferred, double* worst_error = nullptr);

}  // namespace mrhi
