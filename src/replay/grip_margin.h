#pragma once

#include <vector>

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// A contact that grips by its friction at the push that it has.
struct GripContact {
  Vector3 point = Vector3::Zero();   ///< [m]
  Vector3 normal = Vector3::Zero();  ///< unit
  double limit = 0.0;                ///< of the force along the surface [N]
  double lever = 0.0;  ///< that force's, of the torque about the normal that the patch bears [m]
};

/// What has to be borne, about a point.
struct Load {
  Vector3 about = Vector3::Zero();
  Vector3 force = Vector3::Zero();   ///< [N]
  Vector3 torque = Vector3::Zero();  ///< [N m]
};

/// How many times this load friction could bear, force and torque together, with the pushes as they are; less
/// than 1: not even once. It is the least, over all ways in which the object could move, of the power that
/// friction takes at most over the load's own (the upper bound theorem of plastic limit analysis; that of
/// grasps: Goyal, Ruina, Papadopoulos 1991). 0 without contacts; `kNoLoad` where there is no load.
double bearable(const std::vector<GripContact>& grips, const Load& load);
constexpr double kNoLoad = 1e9;

}  // namespace mrhi
