#include <gtest/gtest.h>

#include "support/deep_squeeze.h"

namespace mrhi {
namespace {

using testing::kCarried;
using testing::kDeep;
using testing::kDegrees;
using testing::Squeeze;

class ImplicitSqueeze : public ::testing::TestWithParam<Squeeze> {};

/// Carried for a second after it has been squeezed, then held still: where it is then, the hand must have
/// brought it. The bound is the god object's: a phalanx's own radius.
TEST_P(ImplicitSqueeze, is_held_from_the_sides_that_the_fingertips_entered_without_flip_or_pop_through) {
  Simulation simulation(testing::scene_of(testing::stiff_box(GetParam().size, testing::kSqueezedMass)),
                        testing::implicit_configuration());
  double fastest = 0.0, turned = 0.0;
  testing::play(
      simulation, 0.0, 4.0, 120.0, [](double t) { return GetParam().hand(t); },
      [&](const Simulation& s) {
        const Pose& pose = s.state().bodies[0].pose;
        turned = std::max(turned, pose.orientation.angularDistance(Quaternion::Identity()));
        fastest = std::max(fastest, testing::object_twist(s).linear.norm());
        for (const Contact& contact : s.result().contacts) {
          const double side = finger_of(contact.key.capsule) == 0 ? -1.0 : 1.0;
          EXPECT_GE(side * contact.entry_normal.x(), 0.99);
        }
      });
  const Pose& pose = simulation.state().bodies[0].pose;
  RecordProperty("turned_degrees", std::to_string(turned / kDegrees));
  RecordProperty("off_mm", std::to_string(1e3 * (pose.position - kCarried).norm()));
  EXPECT_LE((pose.position - kCarried).norm(), 0.001);
  EXPECT_LE(turned, 5.0 * kDegrees);
  EXPECT_LE(fastest, 0.3);  // the hand's largest is 0.23 m/s
  for (const int finger : {0, 1}) {
    double depth = 0.0;
    for (const Contact& contact : simulation.result().contacts) {
      if (finger_of(contact.key.capsule) == finger) depth = std::max(depth, contact.depth);
    }
    EXPECT_NEAR(depth, kDeep, 0.001) << finger;
  }
}

INSTANTIATE_TEST_SUITE_P(objects, ImplicitSqueeze,
                         ::testing::Values(Squeeze{"plate_by_tips", {0.010, 0.1, 0.1}, false},
                                           Squeeze{"plate_by_flat_fingers", {0.010, 0.1, 0.1}, true},
                                           Squeeze{"bar_by_tips", {0.020, 0.2, 0.020}, false},
                                           Squeeze{"bar_by_flat_fingers", {0.020, 0.2, 0.020}, true}),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace mrhi
