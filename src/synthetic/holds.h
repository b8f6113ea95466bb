#pragma once

#include <utility>
#include <vector>

#include "motions.h"
#include "mr_hand_interaction/scene/scene.h"

namespace mrhi {

/// A hand on something, in a frame of its owner's.
struct Handhold {
  Pose wrist;
  HandPosture open, near, closed;  ///< near: just off the surface
  Vector3 retreat;                 ///< unit: direction in which the open hand leaves
};

/// A cylinder of the surroundings that fits into a hand.
struct Rail {
  Vector3 centre, axis;  ///< axis: unit [world]
  double half_length, radius;

  double distance(const Vector3& from) const;
  /// Power grip at the place nearest to `at`, of a person with this orientation: the palm towards the rail,
  /// the thumb up or to the other hand. In world.
  Handhold hold(Side side, const Vector3& at, const Quaternion& person) const;
};

/// The rails among the scene's fixtures. Throws std::invalid_argument if there is none.
std::vector<Rail> rails_of(const Scene& scene);

/// Holds of an object that is to go to `place`, in its frame: by two upright bars with both hands, or with
/// the right hand by grasp_of(), and throws as that does.
std::vector<std::pair<Side, Handhold>> holds_of(const Body& object, const Vector3& place);

}  // namespace mrhi
