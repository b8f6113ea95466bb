// What goes wrong around a simulation, and what holds all the same: docs/reliability.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "mr_hand_interaction/live_simulation.h"
#include "mr_hand_interaction/parameters.h"
#include "support/fixtures.h"

namespace mrhi {
namespace {

using testing::at;
using testing::box_body;
using testing::finger;
using testing::scene_of;
using testing::unfiltered;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Scene cube() {
  return scene_of(box_body(Vector3::Constant(0.05), 0.1));
}

/// A fingertip that pushes the cube along +x.
Hand pushing(double t, std::uint32_t id = 1) {
  const Vector3 tip(-0.06 + 0.08 * t, 0.0, 0.003);
  Hand hand = finger(tip - Vector3(0, 0.012, 0), tip + Vector3(0, 0.012, 0), 0.008);
  hand.id = id;
  return hand;
}

bool all_finite(const Simulation& simulation) {
  for (const BodyState& body : simulation.state().bodies)
    if (!body.pose.position.allFinite() || !body.linear_momentum.allFinite()) return false;
  for (const RenderedHand& rendered : simulation.result().rendered)
    for (const Capsule& capsule : rendered.hand.capsules)
      if (!capsule.start.allFinite() || !capsule.end.allFinite()) return false;
  return true;
}

TEST(Faults, of_a_thousand_hands_in_a_message_as_many_are_followed_as_there_is_room_for) {
  Simulation simulation(cube(), unfiltered());
  for (int i = 0; i < 30; ++i) {
    HandFrame frame{at(0.01 * i), {}};
    for (std::uint32_t id = 0; id < 1000; ++id) frame.hands.push_back(pushing(0.01 * i, id));
    ASSERT_EQ(simulation.advance(frame), Rejection::none);
    EXPECT_LE(simulation.result().tracked.size(), static_cast<std::size_t>(kMaxHands));
    EXPECT_TRUE(all_finite(simulation));
  }
  EXPECT_EQ(simulation.advance({at(0.3), {pushing(0.3)}}), Rejection::none);
}

TEST(Faults, two_trackers_of_one_clock_are_taken_in_the_order_of_their_stamps) {
  Simulation simulation(cube(), unfiltered());
  int taken = 0;
  for (int i = 0; i < 100; ++i)
    taken += simulation.advance({at(0.005 * i), {pushing(0.005 * i, i % 2 ? 1u : 2u)}}) == Rejection::none;
  EXPECT_EQ(taken, 100);
}

TEST(Faults, of_two_trackers_with_clocks_apart_the_first_alone_is_taken_and_nothing_restarts) {
  for (const double apart : {-3600.0, -2.0, 2.0, 3600.0}) {
    Simulation simulation(cube(), unfiltered());
    simulation.advance({at(0.0), {pushing(0.0)}});
    for (int i = 1; i < 200; ++i) {
      EXPECT_NE(simulation.advance({at(0.01 * i + 0.005 + apart), {pushing(0.0, 2)}}), Rejection::none)
          << apart;
      EXPECT_EQ(simulation.advance({at(0.01 * i), {pushing(0.01 * i)}}), Rejection::none) << apart;
      EXPECT_FALSE(simulation.result().restarted);
    }
  }
}

TEST(Faults, a_thousand_frames_a_second_and_one_a_minute_are_taken) {
  Simulation fast(cube(), unfiltered()), slow(cube(), unfiltered());
  for (int i = 0; i < 2000; ++i)
    ASSERT_EQ(fast.advance({at(0.001 * i), {pushing(0.001 * i)}}), Rejection::none);
  slow.advance({at(0.0), {}});
  slow.advance({at(60.0), {}});  // far ahead of what is known yet
  for (int i = 2; i < 30; ++i) ASSERT_EQ(slow.advance({at(60.0 * i), {pushing(0.0)}}), Rejection::none);
}

TEST(Faults, a_hand_that_is_not_finite_is_lost_and_named_and_the_next_is_taken) {
  Simulation simulation(cube(), unfiltered());
  for (int i = 0; i < 30; ++i) simulation.advance({at(0.01 * i), {pushing(0.01 * i)}});
  Hand broken = pushing(0.3);
  broken.capsules[capsule_index(1, 3)].start.y() = kNan;
  simulation.advance({at(0.3), {broken}});
  EXPECT_TRUE(all_finite(simulation));
  for (const Hand& hand : simulation.result().tracked)
    EXPECT_TRUE(hand.capsules[capsule_index(1, 3)].start.allFinite());
  ASSERT_FALSE(simulation.result().not_finite.empty());
  EXPECT_EQ(simulation.result().not_finite[0], "hand 1");
  for (int i = 31; i < 60; ++i)
    ASSERT_EQ(simulation.advance({at(0.01 * i), {pushing(0.3)}}), Rejection::none);
  EXPECT_TRUE(simulation.result().not_finite.empty());
  EXPECT_EQ(simulation.result().tracked.size(), 1u);
  EXPECT_TRUE(all_finite(simulation));
}

TEST(Faults, a_body_that_is_not_finite_is_put_back_and_named) {
  Simulation simulation(cube(), unfiltered());
  simulation.advance({at(0.0), {}});
  SimulationState state = simulation.state();
  state.bodies[0].angular_momentum.z() = kNan;
  simulation.set_state(state);
  simulation.advance({at(0.01), {}});
  ASSERT_FALSE(simulation.result().not_finite.empty());
  EXPECT_EQ(simulation.result().not_finite[0], "object 'object'");
  EXPECT_TRUE(all_finite(simulation));
  EXPECT_EQ(simulation.state().bodies[0].pose.position, Vector3::Zero());
  simulation.advance({at(0.02), {}});
  EXPECT_TRUE(simulation.result().not_finite.empty());
}

TEST(Faults, a_hand_whose_drawn_place_is_not_finite_is_drawn_where_it_is_tracked_and_named) {
  Simulation simulation(cube(), unfiltered());
  int i = 0;
  for (; i < 30; ++i) simulation.advance({at(0.01 * i), {pushing(0.01 * i)}});
  SimulationState state = simulation.state();
  state.offsets[0].shift.y() = kNan;
  simulation.set_state(state);
  simulation.advance({at(0.01 * i), {pushing(0.01 * i)}});
  EXPECT_TRUE(all_finite(simulation));
  ASSERT_FALSE(simulation.result().not_finite.empty());
  EXPECT_EQ(simulation.result().not_finite[0], "rendered hand 1");
  ASSERT_EQ(simulation.result().rendered.size(), 1u);
  const std::size_t tip = capsule_index(1, 3);
  EXPECT_EQ(simulation.result().rendered[0].hand.capsules[tip].start,
            simulation.result().tracked[0].capsules[tip].start);
  ++i;
  simulation.advance({at(0.01 * i), {pushing(0.01 * i)}});
  EXPECT_TRUE(simulation.result().not_finite.empty());
}

TEST(Faults, a_contact_that_is_not_finite_is_left_out_and_its_object_named) {
  Simulation simulation(cube(), unfiltered(ContactModelKind::soft_pad));
  int i = 0;
  while (i < 100 && simulation.result().contacts.empty()) {
    simulation.advance({at(0.01 * i), {pushing(0.01 * i)}});
    ++i;
  }
  SimulationState state = simulation.state();
  ASSERT_FALSE(state.contacts.empty()) << "it is never touched";
  for (Contact& contact : state.contacts) contact.god_object.z() = kNan;
  simulation.set_state(state);
  simulation.advance({at(0.01 * i), {pushing(0.01 * i)}});
  EXPECT_TRUE(all_finite(simulation));
  const std::vector<std::string>& named = simulation.result().not_finite;
  EXPECT_NE(std::find(named.begin(), named.end(), "contact with 'object'"), named.end());
  for (const Contact& contact : simulation.result().contacts) EXPECT_TRUE(contact.force.allFinite());
}

/// Each number at either of its ends, alone: a hand that moves and pushes stays finite.
TEST(Faults, no_number_at_an_end_of_its_limits_makes_what_is_not_finite) {
  for (const std::string& name : parameter_names()) {
    const auto limits = parameter_limits(name);
    if (!limits || name == "step") continue;  // a step has tests of its own, and 10 us would take long
    for (const double end : {limits->min, limits->max}) {
      for (const FilterKind filter :
           {FilterKind::none, FilterKind::window, FilterKind::one_euro, FilterKind::constant_velocity}) {
        Configuration configuration;
        configuration.filter.type = filter;
        const std::string number = std::to_string(end);
        set_parameter(configuration, "material/dynamic_friction", "0");
        set_parameter(configuration, name,
                      name == "gravity"         ? "[" + number + ", 0, " + number + "]"
                      : name == "filter/window" ? std::to_string(static_cast<int>(end))
                                                : std::to_string(end));
        Simulation simulation(cube(), configuration);
        for (int i = 0; i < 120; ++i) {
          simulation.advance({at(0.01 * i), {pushing(0.01 * i)}});
          ASSERT_TRUE(simulation.result().not_finite.empty()) << name << " " << end;
          ASSERT_TRUE(all_finite(simulation)) << name << " " << end;
        }
      }
    }
  }
}

TEST(Faults, masses_and_spins_at_the_ends_of_their_limits_stay_finite) {
  for (const double mass : {1e-6, 1e6}) {
    for (const double spin : {0.0, 1000.0}) {
      Body body = box_body(Vector3(0.05, 0.04, 0.03), mass);
      body.start_twist.angular = Vector3(spin, 0, 0.01 * spin).normalized() * spin;
      if (spin == 0.0) body.start_twist.angular.setZero();
      Simulation simulation(scene_of(body), unfiltered(ContactModelKind::implicit));
      for (int i = 0; i < 120; ++i) {
        simulation.advance({at(0.01 * i), {pushing(0.01 * i)}});
        ASSERT_TRUE(simulation.result().not_finite.empty()) << mass << " " << spin;
        ASSERT_TRUE(all_finite(simulation));
      }
    }
  }
}

TEST(Faults, an_object_that_is_removed_while_it_is_pushed_leaves_nothing_behind) {
  LiveSimulation live(cube(), unfiltered(ContactModelKind::implicit));
  Body other = box_body(Vector3::Constant(0.05), 0.1);
  other.name = "other";
  other.start.position.y() = 0.3;
  live.add(other);
  int first = 0;
  while (first < 100 && live.simulation().result().contacts.empty()) {
    live.simulation().advance({at(0.01 * first), {pushing(0.01 * first)}});
    ++first;
  }
  ASSERT_LT(first, 100) << "it is never touched";
  live.remove("object");
  for (int i = first; i < first + 20; ++i) {
    ASSERT_EQ(live.simulation().advance({at(0.01 * i), {pushing(0.01 * i)}}), Rejection::none);
    EXPECT_TRUE(live.simulation().result().contacts.empty());
  }
}

TEST(Faults, a_recording_that_loops_a_hundred_times_is_the_same_each_time) {
  Simulation simulation(cube(), unfiltered(ContactModelKind::implicit));
  std::uint64_t second = 0;
  for (int loop = 0; loop < 100; ++loop) {
    for (int i = 0; i < 100; ++i) simulation.advance({at(0.01 * i), {pushing(0.01 * i)}});
    ASSERT_GT(simulation.state().bodies[0].pose.position.x(), 0.01) << "it is not pushed in loop " << loop;
    if (loop == 1) second = hash(simulation.state());  // the first of those that begin with their third frame
    if (loop > 1) {
      ASSERT_EQ(hash(simulation.state()), second) << loop;
    }
  }
}

}  // namespace
}  // namespace mrhi
