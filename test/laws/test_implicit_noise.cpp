#include <gtest/gtest.h>

#include "support/noisy_pinch.h"

namespace mrhi {
namespace {

using testing::NoisyRide;

NoisyRide ride(const FilterConfiguration& filter, unsigned seed) {
  Configuration configuration = testing::implicit_configuration();
  configuration.filter = filter;
  return testing::noisy_ride(testing::NoisyPinch(seed), configuration);
}

class ImplicitNoise : public ::testing::TestWithParam<unsigned> {
 protected:
  void record(const std::string& name, const NoisyRide& ride) {
    const auto micrometres = [](double metres) { return std::to_string(1e6 * metres); };
    RecordProperty(name + "_true_slip_um", micrometres(ride.true_slip));
    RecordProperty(name + "_displacement_um", micrometres(ride.displacement));
    RecordProperty(name + "_cube_jitter_um", micrometres(ride.cube.rms()));
    RecordProperty(name + "_palm_jitter_um", micrometres(ride.palm.rms()));
    RecordProperty(name + "_fingertip_jitter_um", micrometres(ride.fingertips()));
  }
};

TEST_P(ImplicitNoise,
       through_the_default_filter_a_pinched_cube_neither_slips_nor_jitters_more_than_the_hand) {
  const NoisyRide filtered = ride(FilterConfiguration(), GetParam());
  EXPECT_LE(filtered.true_slip, 0.05e-3);
  EXPECT_LE(filtered.displacement, 0.45e-3);
  EXPECT_LE(filtered.cube.rms(), filtered.fingertips());
  record("filtered", filtered);
  FilterConfiguration none;
  none.type = FilterKind::none;
  record("raw", ride(none, GetParam()));
}

INSTANTIATE_TEST_SUITE_P(seeds, ImplicitNoise, ::testing::Values(1u, 2u, 3u));

}  // namespace
}  // namespace mrhi
