#include "scores.h"

#include <algorithm>
#include <cmath>

#include "support/noisy_pinch.h"
#include "tracking/hand_filter.h"

namespace mrhi::filter_benchmark {

Ride ride(const FilterConfiguration& filter) {
  Configuration configuration = testing::implicit_configuration();
  configuration.filter = filter;
  Ride worst;
  for (const unsigned seed : {1u, 2u, 3u}) {
    const testing::NoisyRide ride = testing::noisy_ride(testing::NoisyPinch(seed), configuration);
    worst.true_slip = std::max(worst.true_slip, ride.true_slip);
    worst.displacement = std::max(worst.displacement, ride.displacement);
    worst.jitter = std::max(worst.jitter, ride.cube.rms());
  }
  return worst;
}

double gain_of_a_shake(const FilterConfiguration& filter) {
  constexpr double kAmplitude = 0.05, kFrequency = 3.0, kRate = 120.0;  // [m], [Hz], [Hz]
  constexpr int kSettled = 120, kFrames = 360;
  FilterMemory memory;
  double largest = 0.0;
  for (int frame = 0; frame < kFrames; ++frame) {
    const double x = kAmplitude * std::sin(2.0 * M_PI * kFrequency * frame / kRate);
    Hand hand = testing::finger(Vector3(x, 0.0, 0.0), Vector3(x, 0.02, 0.0), 0.008);
    hand.palm.position.x() = x;
    const Hand shown = filtered(hand, frame > 0 ? 1.0 / kRate : 0.0, filter, memory);
    if (frame >= kSettled) largest = std::max(largest, std::abs(shown.palm.position.x()));
  }
  return largest / kAmplitude;
}

}  // namespace mrhi::filter_benchmark
