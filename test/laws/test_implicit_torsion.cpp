#include <gtest/gtest.h>

#include "support/bar_by_its_end.h"

namespace mrhi {
namespace {

using testing::kDegrees;
using testing::Swing;

Swing held_by_its_end(bool torsion, double step) {
  Configuration configuration = testing::implicit_configuration();
  configuration.contact.torsion = torsion;
  configuration.step = step;
  return testing::swing_about_finger_line(configuration);
}

TEST(ImplicitTorsion, two_fingertips_hold_a_long_bar_by_its_end_against_turning_about_the_finger_line) {
  for (const double step : {0.001, 1.0 / 119.0}) {
    const Swing swing = held_by_its_end(true, step);
    RecordProperty("largest_degrees", std::to_string(swing.largest / kDegrees));
    EXPECT_TRUE(swing.held);
    EXPECT_LE(swing.largest, 1.0 * kDegrees) << step;
    EXPECT_LE(swing.after, 0.01 * kDegrees) << step;
  }
}

TEST(ImplicitTorsion, without_it_the_bar_swings) {
  const Swing swing = held_by_its_end(false, 0.001);
  RecordProperty("largest_degrees", std::to_string(swing.largest / kDegrees));
  EXPECT_GE(swing.largest, 10.0 * kDegrees);
}

}  // namespace
}  // namespace mrhi
