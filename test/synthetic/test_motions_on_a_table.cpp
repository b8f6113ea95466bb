#include <gtest/gtest.h>

#include "synthetic/performance.h"
#include "training/operator_trial.h"

namespace mrhi {
namespace {

using testing::Moment;
using testing::Staging;

constexpr double kDegrees = M_PI / 180.0;

/// At 1 g from the start, under `implicit`; what the object stands on carries it until the hand does.
Staging on_a_table() {
  Staging staging;
  staging.gravity = -9.81;
  staging.stand = stand_under;
  return staging;
}

class GraspingMotionOnATable : public ::testing::TestWithParam<const char*> {};

// The object sags by m g / sum of k = 0.05 to 0.15 mm as the hand takes its weight, and turns where the grip
// is above or below its centre of mass. A plate that fingers scrape off the table slips on them until they
// press in full: measured 1.2 mm and 2.4 degrees, 0.4 mm with fingers that nothing stops.
TEST_P(GraspingMotionOnATable, lifts_what_stands_there_and_carries_it) {
  const ScriptedMotion motion = make_motion(GetParam());
  const double from = testing::carrying_from(motion), to = testing::opening_from(motion);
  const auto moments = testing::perform(GetParam(), on_a_table());
  const double sag = std::string(GetParam()) == "lift_flat" ? 0.0015 : 5e-4;  // [m]
  const double untouched = motion.keyframes.at(1).time;
  EXPECT_LT((testing::moment_at(moments, untouched).object.position - moments[0].object.position).norm(),
            2e-5);
  EXPECT_TRUE(testing::held_throughout(moments, from, to));
  const Moment &start = testing::moment_at(moments, from), &end = testing::moment_at(moments, to);
  EXPECT_NEAR(end.object.position.z() - start.object.position.z(), 0.08, sag);
  const testing::Shift shift = testing::shift_in_hand(moments, from, to);
  EXPECT_LT(shift.way, sag);
  EXPECT_LT(shift.turn, 3.0 * kDegrees);
  EXPECT_FALSE(moments.back().held);
}

INSTANTIATE_TEST_SUITE_P(All, GraspingMotionOnATable,
                         ::testing::Values("grasp_cube", "grasp_ball", "pinch_long", "lift_flat"));

// The finger goes 45 mm beyond the place where it meets the cube.
TEST(StrikingMotionOnATable, nudge_slides_the_cube_forward_where_it_comes_to_rest) {
  const auto moments = testing::perform("nudge", on_a_table());
  const Vector3 way = moments.back().object.position - moments[0].object.position;
  EXPECT_NEAR(way.y(), 0.045, 0.005);
  EXPECT_LT(std::abs(way.x()), 0.002);
  EXPECT_LT(std::abs(way.z()), 1e-4);
  EXPECT_LT(moments.back().twist.linear.norm(), 1e-4);
}

// The table stands in the way: the finger is felt, and the cube stays.
TEST(StrikingMotionOnATable, tap_leaves_the_cube_where_it_is) {
  const auto moments = testing::perform("tap", on_a_table());
  EXPECT_LT((moments.back().object.position - moments[0].object.position).norm(), 0.001);
  EXPECT_LT(moments.back().twist.linear.norm(), 1e-4);
  const Vector3 fastest = testing::struck_velocity("tap", on_a_table());
  EXPECT_GT(fastest.norm(), 0.005);
  EXPECT_LT(fastest.norm(), 0.1);
}

// As without weight: Newton's law with restitution 0.3 at 1.5 m/s.
TEST(StrikingMotionOnATable, slap_drives_the_cube_off) {
  double fastest = 0.0;
  for (const Moment& moment : testing::perform("slap", on_a_table()))
    fastest = std::min(fastest, moment.twist.linear.x());
  EXPECT_NEAR(fastest, -1.95, 0.6);
}

}  // namespace
}  // namespace mrhi
