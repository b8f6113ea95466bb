#pragma once

#include <optional>

#include "mr_hand_interaction/configuration.h"
#include "mr_hand_interaction/tracking/filter_memory.h"

namespace mrhi {

constexpr int kMaxHands = 4;  ///< followed at once

/// After a short loss the hand does not snap from where it was held to where it is: it catches up, continuous
/// in velocity and never ahead of the tracked hand.
struct Rejoin {
  Hand from;                 ///< pose that was held
  Nanoseconds begin = 0;     ///< stamp of the first frame after the loss
  Nanoseconds duration = 0;  ///< 0: not catching up
};

/// While one filter takes over from another the hand goes from the pose of the one to that of the other.
struct FilterChange {
  FilterConfiguration from;
  FilterMemory memory;  ///< of the old filter, which runs on meanwhile
  Nanoseconds begin = 0;
};

/// One hand followed through time.
struct HandTrack {
  bool active = false;    ///< false: this slot is free
  bool held = false;      ///< not in the last frame: keeps its pose until hold_time is over
  bool appeared = false;  ///< at the last frame it came from nowhere, or jumped: it was not there before
  bool emerged = false;   ///< at the frame before: what it overlaps as it begins to move is ignored
  Hand previous;          ///< filtered pose at the frame before
  Hand current;           ///< filtered pose at the last frame
  Nanoseconds last_seen = 0;
  FilterMemory filter;
  Rejoin rejoin;
  std::optional<FilterChange> filter_change;
};

/// How long a hand takes to catch up with one that has gone `way` [m] in the `away` seconds of its loss and
/// goes on as fast: what keeps it to 5 m/s^2, but 0.05 to 0.4 s.
Nanoseconds rejoin_duration(double way, double away);

/// The hand at `stamp` on its way from where it was held to the tracked hand (minimum jerk: Flash & Hogan
/// 1985).
Hand catching_up(const Rejoin& rejoin, const Hand& tracked, Nanoseconds stamp);

/// Longest way of a joint that both hands have [m].
double farthest_joint(const Hand& from, const Hand& to);

/// Pose between two of one hand: all points move on straight lines.
Hand blend(const Hand& from, const Hand& to, double fraction);

}  // namespace mrhi
