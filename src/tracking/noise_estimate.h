#pragma once

#include "mr_hand_interaction/tracking/filter_memory.h"

namespace mrhi {

/// Two third differences of four samples each, one sample apart.
constexpr int kNoiseSamples = 5;  ///< of the history, from which observe_noise learns

/// Learns from the newest samples how much they tremble; nothing while there are fewer than kNoiseSamples.
void observe_noise(const SampleHistory& history, SeenNoise& noise);

/// What a filter is to take for the rms of a sample on an axis [m]: a good tracker's, and beyond that what
/// has been seen.
///     sigma^2 = kUsualNoise^2 + 4 max(0, s^2 - (1 mm)^2),   s^2 the variance that has been seen
double filter_noise(const SeenNoise& seen);

}  // namespace mrhi
