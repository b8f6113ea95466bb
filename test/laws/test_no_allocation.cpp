#include <gtest/gtest.h>

#include "mr_hand_interaction/response/contact_model.h"
#include "support/count_allocations.h"
#include "support/grips.h"
#include "support/lid.h"

namespace mrhi {
namespace {

using testing::allocations;
using testing::PinchScene;

/// Allocations in the steps (not in taking and reporting frames) of two seconds of scene (a), once warm.
long allocations_while_swinging(Scene scene, ContactModelKind model) {
  const PinchScene pinch;
  scene.bounds = {Vector3::Constant(-1e3), Vector3::Constant(1e3)};  // to be put back is an event
  Configuration configuration = testing::unfiltered(model);
  Simulation simulation(std::move(scene), configuration);
  long counted = 0;
  for (int frame = 0; frame < 300; ++frame) {
    const double t = frame / 100.0;
    const Vector3 sway = testing::smooth(t - 0.5, 0.5) * testing::swing(t - 0.5, 0.1, 0.5);
    simulation.begin({testing::at(t), {pinch.hand(t, sway)}});
    const long before = allocations;
    while (simulation.step()) {
    }
    if (t >= 1.0) counted += allocations - before;
    simulation.end();
  }
  return counted;
}

TEST(NoAllocation, counting_works) {
  const long before = allocations;
  std::vector<int> some(1000);
  EXPECT_EQ(some.size(), 1000u);
  EXPECT_GT(allocations, before);
}

TEST(NoAllocation, in_a_step_of_a_held_cube_once_warm) {
  for (const ContactModelEntry* model : contact_models())
    EXPECT_EQ(allocations_while_swinging(PinchScene().scene(), {model->name}), 0) << model->name;
}

TEST(NoAllocation, in_a_step_with_far_objects_and_with_one_that_rides_on_the_held_cube) {
  Scene scene = PinchScene().scene();
  for (int i = 0; i < 19; ++i) {
    Body far = testing::box_body(Vector3::Constant(0.05), 0.1);
    far.name = "far" + std::to_string(i);
    far.start.position = Vector3(0.6 + 0.2 * (i % 3), 0.2 * (i / 3), 0.5);
    scene.bodies.push_back(far);
  }
  EXPECT_EQ(allocations_while_swinging(scene, ContactModelKind::implicit), 0);
  Body rider = testing::box_body(Vector3::Constant(0.04), 0.03);
  rider.name = "rider";
  rider.start.position = Vector3(0, 0, 0.045);
  scene.bodies.push_back(rider);
  EXPECT_EQ(allocations_while_swinging(scene, ContactModelKind::implicit), 0);
}

/// A finger that strikes a lid again and again, which comes back by a spring: blows of what hangs on joints.
TEST(NoAllocation, in_a_step_of_a_struck_lid_once_warm) {
  testing::Lid lid;
  Scene scene = lid.scene();
  scene.joints[0].spring = JointSpring{1.0, 0.0};
  Simulation simulation(scene, testing::unfiltered(ContactModelKind::implicit));
  long counted = 0, blows = 0;
  for (int frame = 0; frame < 400; ++frame) {
    const double t = frame / 100.0;
    const Vector3 place(lid.at, 0, -0.05 + 0.04 * std::sin(2.0 * M_PI * t));
    simulation.begin(
        {testing::at(t),
         {testing::finger(place - Vector3(0, 0.01, 0), place + Vector3(0, 0.01, 0), lid.radius)}});
    const long before = allocations;
    while (simulation.step()) {
    }
    if (t >= 2.0) counted += allocations - before;
    simulation.end();
    for (const Contact& contact : simulation.result().contacts)
      blows += t >= 2.0 && contact.impulse.norm() > 0.0;
  }
  EXPECT_GE(blows, 2);
  EXPECT_EQ(counted, 0);
}

}  // namespace
}  // namespace mrhi
