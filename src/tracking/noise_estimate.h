#pragma once

#include "mr_hand_interaction/tracking/filter_memory.h"

namespace mrhi {

constexpr int kNoiseSamples = 5;  ///< of the history, from which observe_noise learns

/// Learns from the newest samples how much they tremble; nothing while there are fewer than kNoiseSamples.
void observe_noise(const SampleHistory& history, SeenNoise& noise);

/// What a filter is to take for the rms of a sample on an axis [m]: a good tracker's, and beyond that what
/// has been seen.
double filter_noise(const SeenNoise& seen);

}  // namespace mrhi
