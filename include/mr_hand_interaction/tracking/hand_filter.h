#pragma once

#include "mr_hand_interaction/configuration.h"
#include "mr_hand_interaction/tracking/hand_track.h"

namespace mrhi {

/// Samples that the filter wants kept.
int history_length(const FilterConfiguration& filter);

/// The filtered hand for the newest sample of a history that has at least one. `window`: Eq. 1 read as the
/// mean of the last F frames, fewer at the start; the palm's orientation is the chordal mean (Markley et al.
/// 2007); a phalanx is averaged over the newest unbroken run of samples that have it.
Hand filtered(const SampleHistory& history, const FilterConfiguration& filter);

}  // namespace mrhi
