#include "tracker.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "../math/minimum_jerk.h"
#include "hand_filter.h"

namespace mrhi {
namespace {

/// A hand with a new id continues a held one if it is no farther from it than this [m].
constexpr double kSameHandDistance = 0.3;

/// One filter takes over from another within this time [s].
constexpr double kFilterChange = 0.2;

using Assignment = std::array<int, kMaxHands>;  // slot -> index in the frame, -1: none

bool is_assigned(const Assignment& assignment, int hand) {
  return std::find(assignment.begin(), assignment.end(), hand) != assignment.end();
}

template <typename Fits>
void assign(const std::vector<Hand>& seen, const std::vector<HandTrack>& hands, Fits fits,
            Assignment& assignment) {
  for (std::size_t slot = 0; slot < hands.size(); ++slot) {
    for (int i = 0; i < static_cast<int>(seen.size()) && assignment[slot] < 0; ++i) {
      if (!is_assigned(assignment, i) && fits(hands[slot], seen[static_cast<std::size_t>(i)]))
        assignment[slot] = i;
    }
  }
}

/// A free slot that knows what noise hands of this side have.
bool was_last_here(const HandTrack& track, const Hand& hand) {
  return !track.active && track.filter.noise.size > 0 && track.current.side == hand.side;
}

bool knows_nothing(const HandTrack& track, const Hand&) {
  return !track.active && track.filter.noise.size == 0;
}

/// The surest first, each for all slots, before the next: id and side, id alone (a tracker that took a left
/// for a right hand), a new id near a hand that is held; then free slots, those that know the noise of this
/// side first. In the order of slots and of the frame: equal frames give equal tracks.
Assignment assign_hands(const std::vector<Hand>& seen, const std::vector<HandTrack>& hands) {
  Assignment assignment;
  assignment.fill(-1);
  const auto same_id = [](const HandTrack& track, const Hand& hand) {
    return track.active && track.current.id == hand.id;
  };
  assign(
      seen, hands,
      [&](const HandTrack& track, const Hand& hand) {
        return same_id(track, hand) && track.current.side == hand.side;
      },
      assignment);
  assign(seen, hands, same_id, assignment);
  assign(
      seen, hands,
      [](const HandTrack& track, const Hand& hand) {
        return track.active && track.current.side == hand.side &&
               (track.current.palm.position - hand.palm.position).norm() < kSameHandDistance;
      },
      assignment);
  assign(seen, hands, was_last_here, assignment);
  assign(seen, hands, knows_nothing, assignment);
  assign(
      seen, hands, [](const HandTrack& track, const Hand&) { return !track.active; }, assignment);
  return assignment;
}

/// Before and now are one pose, so that it has no velocity: what it overlaps is not struck by its coming.
void appear(const Hand& hand, Nanoseconds stamp, HandTrack& track) {
  track.active = true;
  track.held = false;
  track.appeared = true;
  track.emerged = false;
  track.filter.restart(hand);
  track.previous = track.current = hand;
  track.path = HandPath();
  track.mean_velocity = HandVelocity();
  track.last_seen = stamp;
  track.rejoin.duration = 0;
  track.filter_change.reset();
}

/// Both filters run on the same samples, and the hand is (1 - s) old + s new, with s of minimum jerk, whose
/// first two derivatives are 0 at both ends.
Hand filtered_through_change(const Hand& hand, Nanoseconds stamp, const Configuration& configuration,
                             HandTrack& track) {
  const double elapsed = to_seconds(stamp - track.last_seen);
  const Hand now = filtered(hand, elapsed, filter_of(configuration), track.filter);
  if (!track.filter_change) return now;
  FilterChange& change = *track.filter_change;
  const Hand before = filtered(hand, elapsed, change.from, change.memory);
  const double u = to_seconds(stamp - change.begin) / kFilterChange;
  if (u >= 1.0) {
    track.filter_change.reset();
    return now;
  }
  return blend(before, now, minimum_jerk(u));
}

/// The jump is told by raw samples: what is filtered lags behind, and the difference would look like a leap.
/// A hand that was held begins its filter anew, as its samples of before say nothing about now, and catches
/// up from the pose that was shown.
void follow(const Hand& hand, Nanoseconds stamp, const Configuration& configuration, HandTrack& track) {
  const double away = to_seconds(stamp - track.last_seen);
  if (farthest_joint(track.filter.history.samples[0], hand) > configuration.tracking.max_speed * away) {
    appear(hand, stamp, track);
    return;
  }
  if (track.held) {
    track.filter.clear();
    track.filter_change.reset();
    track.rejoin = {track.current, stamp, rejoin_duration(farthest_joint(track.current, hand), away)};
  }
  track.emerged = track.appeared;
  track.appeared = track.held = false;
  track.previous = track.current;
  track.current = filtered_through_change(hand, stamp, configuration, track);
  track.last_seen = stamp;
  if (track.rejoin.duration > 0) {
    track.current = catching_up(track.rejoin, track.current, stamp);
    if (stamp - track.rejoin.begin >= track.rejoin.duration) track.rejoin.duration = 0;
  }
  extend_path(away, track);
}

/// Its last two poses are one: the hand stands still.
void hold(HandTrack& track) {
  track.held = true;
  track.emerged = track.appeared;
  track.appeared = false;
  track.previous = track.current;
  track.path = HandPath();
}

}  // namespace

void track_hands(const HandFrame& frame, const Configuration& configuration, std::vector<HandTrack>& hands,
                 std::vector<Event>& events) {
  const Assignment assignment = assign_hands(frame.hands, hands);
  for (std::size_t slot = 0; slot < hands.size(); ++slot) {
    HandTrack& track = hands[slot];
    if (assignment[slot] < 0) {
      if (track.active) hold(track);
      continue;
    }
    Hand hand = frame.hands[static_cast<std::size_t>(assignment[slot])];
    for (Capsule& capsule : hand.capsules) capsule.radius *= configuration.hand_radius_scale;
    if (track.active) {
      follow(hand, frame.stamp, configuration, track);
    } else {
      if (!was_last_here(track, hand)) track.filter.noise = SeenNoise();
      appear(hand, frame.stamp, track);
      events.push_back({frame.stamp, EventKind::hand_found, -1, hand.id});
    }
  }
}

void check_filter(FilterKind kind) {
  hand_filter(kind);
}

/// The new filter starts from the last pose shown, at rest and knowing nothing of its own error; the old one
/// runs on beside it with all that it knew.
void change_filter(const FilterConfiguration& from, Nanoseconds now, std::vector<HandTrack>& hands) {
  for (HandTrack& track : hands) {
    if (!track.active || track.filter.empty()) continue;
    track.filter_change = FilterChange{from, track.filter, now};
    track.filter.velocity = HandVelocity();
    track.filter.variance = MotionVariance();
  }
}

/// What is known of the tracker's noise stays in the slot, for the next hand of its side.
void lose_unseen_hands(Nanoseconds now, double hold_time, std::vector<HandTrack>& hands,
                       std::vector<Event>& events) {
  for (HandTrack& track : hands) {
    if (!track.active || to_seconds(now - track.last_seen) <= hold_time) continue;
    track.active = false;
    track.filter.clear();
    events.push_back({now, EventKind::hand_lost, -1, track.current.id});
  }
}

}  // namespace mrhi
