#include <gtest/gtest.h>

#include <cmath>

#include "rendering/renderer.h"

namespace mrhi {
namespace {

constexpr Nanoseconds kFrame = 8'333'333;
constexpr double kTurned = 0.1;  // [rad]

double angle(const Quaternion& turn) {
  return turn.angularDistance(Quaternion::Identity());
}

HandOffset lagging(double turned) {
  const Quaternion turn(Eigen::AngleAxisd(turned, Vector3(1, 2, 2) / 3.0));
  HandOffset offset;
  offset.lag = {turn, turn};
  return offset;
}

TEST(ReturnHome, a_palm_that_lags_takes_a_fingertip_back_by_no_more_than_is_seen_as_a_jump) {
  const PalmLag left = lag_returning(lagging(kTurned), kFrame);
  // 0.4 mm in a frame: at 0.15 m from the palm's position, and at 0.1 m from a finger's root.
  EXPECT_NEAR(kTurned - angle(left.whole), 0.0004 / 0.15, 1e-9);
  EXPECT_NEAR(kTurned - angle(left.frame), 0.0004 / 0.1, 1e-9);
}

TEST(ReturnHome, a_small_lag_decays_in_a_twentieth_of_a_second_and_ends) {
  const PalmLag left = lag_returning(lagging(0.01), kFrame);
  EXPECT_NEAR(angle(left.frame), 0.01 * std::exp(-8.333333e-3 / 0.05), 1e-9);
  EXPECT_TRUE(lag_returning(lagging(1e-6), kFrame).zero()) << "nearer than a micrometre is back";
}

}  // namespace
}  // namespace mrhi
