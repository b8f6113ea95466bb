#include <gtest/gtest.h>

#include "ros/result_messages.h"
#include "support/pinched_cube.h"

namespace mrhi {
namespace {

using mr_hand_interaction::HapticsArray;
using mr_hand_interaction::PhalanxHaptics;

Contact contact(std::uint16_t body, std::uint8_t hand, int capsule, std::uint8_t point,
                const Vector3& force) {
  Contact made;
  made.key = {point, 0, static_cast<std::uint8_t>(capsule), hand, body};
  made.force = force;
  made.depth = 0.001;
  return made;
}

struct Felt {
  Felt() : scene(testing::scene_of(testing::box_body({0.05, 0.05, 0.05}, 0.1))) {
    scene.bodies.push_back(testing::ball_body(0.03, 0.1));
    scene.bodies.back().name = "ball";
    state.hands.resize(kMaxHands);
    state.hands[1].active = true;
    state.hands[1].current.id = 7;
    state.hands[1].current.side = Side::right;
  }
  HapticsArray message() const { return haptics_message(scene, state, contacts, {}); }

  Scene scene;
  SimulationState state;
  std::vector<Contact> contacts;
};

TEST(Haptics, a_hand_that_touches_nothing_is_there_with_no_phalanx) {
  const HapticsArray message = Felt().message();
  ASSERT_EQ(message.hands.size(), 1u);
  EXPECT_EQ(message.hands[0].id, 7u);
  EXPECT_EQ(message.hands[0].side, 1);
  EXPECT_TRUE(message.hands[0].phalanges.empty());
}

TEST(Haptics, points_of_one_phalanx_on_one_object_are_added) {
  Felt felt;
  const int tip = capsule_index(1, 3);
  felt.contacts = {contact(0, 1, tip, 0, {0.2, 0, -1}), contact(0, 1, tip, 1, {0, 0, -2})};
  felt.contacts[1].friction = Friction::slipping;
  felt.contacts[1].depth = 0.003;
  felt.contacts[0].impulse = {0, 0, -0.01};
  felt.contacts[1].peak_force = 5.0;
  const HapticsArray message = felt.message();
  ASSERT_EQ(message.hands[0].phalanges.size(), 1u);
  const PhalanxHaptics& phalanx = message.hands[0].phalanges[0];
  EXPECT_EQ(phalanx.object, "object");
  EXPECT_EQ(phalanx.finger, 1);
  EXPECT_EQ(phalanx.bone, 3);
  EXPECT_DOUBLE_EQ(phalanx.force.x, 0.2);
  EXPECT_DOUBLE_EQ(phalanx.force.z, -3.0);
  EXPECT_DOUBLE_EQ(phalanx.pressure, 3.0);  // normals along z
  EXPECT_DOUBLE_EQ(phalanx.impulse.z, -0.01);
  EXPECT_DOUBLE_EQ(phalanx.peak_force, 5.0);
  EXPECT_DOUBLE_EQ(phalanx.depth, 0.003);
  EXPECT_EQ(phalanx.slip, PhalanxHaptics::SLIPPING);
}

TEST(Haptics, each_object_and_phalanx_has_its_own_entry_and_what_only_comes_near_has_none) {
  Felt felt;
  const int tip = capsule_index(1, 3), thumb = capsule_index(0, 3);
  felt.contacts = {contact(0, 1, thumb, 0, {0, 0, 0}), contact(0, 1, tip, 0, {0, 0, 0}),
                   contact(1, 1, tip, 0, {3, 0, 0}), contact(1, 1, kPalm, 0, {4, 0, 0})};
  felt.contacts[0].depth = -0.0005;
  felt.contacts[1].ignored = true;
  const HapticsArray message = felt.message();
  ASSERT_EQ(message.hands[0].phalanges.size(), 2u);
  EXPECT_EQ(message.hands[0].phalanges[0].object, "ball");
  EXPECT_EQ(message.hands[0].phalanges[0].finger, 1);
  EXPECT_EQ(message.hands[0].phalanges[0].slip, PhalanxHaptics::STICKING);
  EXPECT_EQ(message.hands[0].phalanges[1].finger, mr_hand_interaction::Phalanx::PALM);
}

TEST(Haptics, a_touch_that_has_ended_within_the_frame_is_felt_by_its_mean_force) {
  Felt felt;
  felt.contacts = {contact(0, 1, kPalm, 0, {0, 0, -2})};
  felt.contacts[0].depth = 0.0;
  const HapticsArray message = felt.message();
  ASSERT_EQ(message.hands[0].phalanges.size(), 1u);
  EXPECT_EQ(message.hands[0].phalanges[0].force.z, -2.0);
  EXPECT_EQ(message.hands[0].phalanges[0].peak_force, 2.0);  // at least
}

TEST(Haptics, another_hands_contacts_are_not_felt) {
  Felt felt;
  felt.contacts = {contact(0, 0, kPalm, 0, {1, 0, 0}), contact(0, 2, kPalm, 0, {1, 0, 0})};
  EXPECT_TRUE(felt.message().hands[0].phalanges.empty());
}

Vector3 sum_over_phalanges(const HapticsArray& message, geometry_msgs::Vector3 PhalanxHaptics::*part) {
  Vector3 sum = Vector3::Zero();
  for (const auto& phalanx : message.hands.at(0).phalanges) {
    sum += Vector3((phalanx.*part).x, (phalanx.*part).y, (phalanx.*part).z);
  }
  return sum;
}

TEST(Haptics, of_each_step_are_what_changes_the_objects_momentum) {
  const Vector3 gravity(0, 0, -2.0);
  constexpr double kStep = 1.0 / testing::PinchedCube::kRate;
  testing::PinchedCube pinched(ContactModelKind::implicit, gravity);
  Vector3 before = Vector3::Zero();
  int felt = 0;
  pinched.hold(0.4, [&] {
    const Simulation& simulation = pinched.simulation();
    const HapticsArray message =
        haptics_message(simulation.scene(), simulation.state(), simulation.state().contacts, {});
    const Vector3 momentum = pinched.cube().linear_momentum;
    if (!message.hands.at(0).phalanges.empty()) {
      const Vector3 given = kStep * sum_over_phalanges(message, &PhalanxHaptics::force) +
                            sum_over_phalanges(message, &PhalanxHaptics::impulse) +
                            kStep * pinched.body().mass * gravity;
      // Newton's second law, to the error that the solver accepts after a good warm start: 1e-4 of the
      // forces, here 6.4 N on each side. Measured 0.34 mN.
      EXPECT_LT((momentum - before - given).norm(), 6.4e-4 * kStep);
      ++felt;
    }
    before = momentum;
  });
  EXPECT_GT(felt, 150);
}

}  // namespace
}  // namespace mrhi
