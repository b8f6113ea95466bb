#pragma once

#include "mr_hand_interaction/configuration.h"
#include "mr_hand_interaction/tracking/filter_memory.h"

namespace mrhi {

/// The filters, one file each. The newest sample, taken `elapsed` seconds after the one before, is in front
/// of the memory's history; the rest of the memory is as the frame before left it, but for `filtered`, which
/// the caller keeps.

/// Eq. 1 read as the mean of the last F frames, fewer at the start; the palm's orientation is the chordal
/// mean (Markley et al. 2007); a phalanx is averaged over the newest unbroken run of samples that have it.
Hand window_mean(const FilterConfiguration& filter, const FilterMemory& memory);

/// A low-pass whose cutoff grows with the hand's speed (Casiez, Roussel & Vogel 2012), one cutoff for the
/// whole hand.
Hand one_euro(double elapsed, const FilterConfiguration& filter, FilterMemory& memory);

/// Every point goes on as it went, but for accelerations unknown: a Kalman filter of position and velocity,
/// one gain for the whole hand. The acceleration expected grows with the hand's speed.
Hand constant_velocity(double elapsed, const FilterConfiguration& filter, FilterMemory& memory);

constexpr int kNoiseSamples = 5;  ///< of the history, from which observe_noise learns

/// Learns from the newest samples how much they tremble; nothing while there are fewer than kNoiseSamples.
void observe_noise(const SampleHistory& history, SeenNoise& noise);

/// What a filter is to take for the rms of a sample on an axis [m]: a good tracker's, and beyond that what
/// has been seen.
double filter_noise(const SeenNoise& seen);

/// Root mean square over the points of the capsules that `hand` has [m/s].
double rms_speed(const HandVelocity& velocity, const Hand& hand);

}  // namespace mrhi
