#pragma once

#include <vector>

#include "mr_hand_interaction/configuration.h"
#include "mr_hand_interaction/interaction.h"
#include "mr_hand_interaction/tracking/hand_track.h"

namespace mrhi {

/// Assigns the frame's hands to tracks (by id; a new id on the same side, near a hand that is held, continues
/// it), filters them, holds those that are missing, and reports hand_found. Call lose_unseen_hands first.
/// `hands` has kMaxHands slots; further hands are left out.
void track_hands(const HandFrame& frame, const Configuration& configuration, std::vector<HandTrack>& hands,
                 std::vector<Event>& events);

/// Throws std::invalid_argument for a filter that is not known.
void check_filter(FilterKind kind);

/// From `now` on the hands are filtered otherwise: continuous in position and velocity, within 0.2 s.
void change_filter(const FilterConfiguration& from, Nanoseconds now, std::vector<HandTrack>& hands);

/// Ends every track that was last seen more than hold_time before `now`, with hand_lost.
void lose_unseen_hands(Nanoseconds now, double hold_time, std::vector<HandTrack>& hands,
                       std::vector<Event>& events);

}  // namespace mrhi
