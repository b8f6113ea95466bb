#include "held.h"

#include <algorithm>

#include "support/noisy_pinch.h"

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

}  // namespace mrhi::filter_benchmark
