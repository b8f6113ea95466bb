#include "replay/grip_margin.h"

#include <gtest/gtest.h>

namespace mrhi {
namespace {

const Vector3 kNone = Vector3::Zero();

constexpr double kHalf = 0.02, kLimit = 4.0;  // [m], [N]
constexpr double kExact = 1e-3;               // of 1: what the iteration leaves

/// Thumb and finger at the ends of an axis, each bearing 4 N.
std::vector<GripContact> pinch(double lever) {
  return {{{kHalf, 0, 0}, Vector3::UnitX(), kLimit, lever},
          {{-kHalf, 0, 0}, -Vector3::UnitX(), kLimit, lever}};
}

TEST(GripMargin, a_straight_load_is_shared_by_all_fingers) {
  EXPECT_NEAR(bearable(pinch(0.0), {kNone, {0, 0, -2.0}, kNone}), 2.0 * kLimit / 2.0, 4.0 * kExact);
}

TEST(GripMargin, a_turn_across_the_grip_has_the_distance_of_the_fingers_as_its_lever) {
  const double most = 2.0 * kLimit * kHalf;
  EXPECT_NEAR(bearable(pinch(0.0), {kNone, kNone, {0, 0, 0.5 * most}}), 2.0, 2.0 * kExact);
}

TEST(GripMargin, a_turn_about_the_grip_is_borne_by_the_patches_alone) {
  EXPECT_LT(bearable(pinch(0.0), {kNone, kNone, {0.01, 0, 0}}), kExact);
  EXPECT_NEAR(bearable(pinch(0.005), {kNone, kNone, {0.01, 0, 0}}), 2.0 * kLimit * 0.005 / 0.01,
              4.0 * kExact);
}

TEST(GripMargin, force_and_torque_together_are_less_than_either_alone) {
  const double force = 1.6 * kLimit, torque = 1.2 * kLimit * kHalf;  // 0.8 and 0.6 of what is borne: a circle
  EXPECT_NEAR(bearable(pinch(0.0), {kNone, {0, 0, force}, kNone}), 1.0 / 0.8, 2.0 * kExact);
  // One finger bears 0.8 + 0.6 of the limit, the other 0.2.
  EXPECT_NEAR(bearable(pinch(0.0), {kNone, {0, force, 0}, {0, 0, torque}}), 1.0 / 1.4, 2.0 * kExact);
  // Across each other they add as the sides of a triangle do.
  EXPECT_NEAR(bearable(pinch(0.0), {kNone, {0, 0, force}, {0, 0, torque}}), 1.0, 2.0 * kExact);
}

TEST(GripMargin, a_load_along_the_push_is_not_friction_s_and_none_is_borne_for_ever) {
  EXPECT_LT(bearable(pinch(0.01), {kNone, {1.0, 0, 0}, kNone}), kExact);
  EXPECT_EQ(bearable(pinch(0.01), {kNone, kNone, kNone}), kNoLoad);
  EXPECT_LT(bearable({}, {kNone, {0, 0, 1.0}, kNone}), kExact);
}

TEST(GripMargin, where_the_load_is_taken_about_makes_no_difference) {
  const Vector3 force(0.5, 1.0, -2.0), torque(0.01, 0.02, 0.03), away(0.3, -0.2, 0.1);
  std::vector<GripContact> grips = pinch(0.004);
  grips.push_back({{0, kHalf, 0.01}, Vector3::UnitY(), 3.0, 0.004});
  const double here = bearable(grips, {kNone, force, torque});
  EXPECT_NEAR(bearable(grips, {away, force, torque - away.cross(force)}), here, 0.01 * here);
}

}  // namespace
}  // namespace mrhi
