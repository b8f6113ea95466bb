#pragma once

#include <utility>

#include "adult_hand.h"
#include "tracking/joints_input.h"

namespace mrhi {

inline const Vector3 kAway(0.3, -0.2, 0.5);  // where no joint is at the origin

inline HandJoints hand_away(Side side = Side::right) {
  HandJoints hand = adult_hand(side);
  *hand.wrist += kAway;
  *hand.palm_centre += kAway;
  for (auto& finger : hand.joints)
    for (auto& joint : finger) *joint += kAway;
  return hand;
}

/// A frame of a hand as of a tracker of joints alone: without palm and sizes.
inline TrackerFrame frame_of(HandJoints hand, Nanoseconds stamp) {
  hand.palm_centre.reset();
  hand.palm_width.reset();
  hand.finger_width.fill(std::nullopt);
  return {"tracker", {stamp, {std::move(hand)}}, {}, stamp};
}

}  // namespace mrhi
