#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "support/fixtures.h"

namespace mrhi {
namespace {

using testing::at;
using testing::box_body;
using testing::finger;
using testing::scene_of;
using testing::unfiltered;

constexpr double kTrackerRate = 110.0;

/// A fingertip that pushes the cube along +x and sways.
Hand pushing(double t) {
  const Vector3 tip(-0.06 + 0.08 * t, 0.004 * std::sin(9.0 * t), 0.003);
  return finger(tip - Vector3(0, 0.012, 0), tip + Vector3(0, 0.012, 0), 0.008);
}

Scene drifting_cube() {
  Body cube = box_body(Vector3::Constant(0.05), 0.1);
  cube.start_twist = {Vector3(0.01, 0, 0.005), Vector3(0.3, 1.0, -0.2)};
  return scene_of(cube);
}

std::uint64_t run(Simulation& simulation, int from, int to) {
  for (int i = from; i < to; ++i) {
    const double t = i / kTrackerRate;
    simulation.advance({at(t), {pushing(t)}});
  }
  return hash(simulation.state());
}

TEST(Determinism, the_same_frames_give_the_same_bits) {
  Simulation first(drifting_cube(), unfiltered()), second(drifting_cube(), unfiltered());
  EXPECT_EQ(run(first, 0, 100), run(second, 0, 100));
  EXPECT_NE(run(first, 100, 101), hash(second.state()));
}

TEST(Determinism, the_hash_does_not_depend_on_the_time_of_day) {
  Simulation now(drifting_cube(), unfiltered()), later(drifting_cube(), unfiltered());
  run(now, 0, 60);
  for (int i = 0; i < 60; ++i)
    later.advance({at(i / kTrackerRate) + 86'400'000'000'000, {pushing(i / kTrackerRate)}});
  EXPECT_EQ(hash(now.state()), hash(later.state()));
}

TEST(Determinism, a_copied_state_goes_on_with_the_same_bits) {
  Simulation first(drifting_cube(), unfiltered()), second(drifting_cube(), unfiltered());
  run(first, 0, 60);
  second.set_state(first.state());
  EXPECT_EQ(run(first, 60, 120), run(second, 60, 120));
}

TEST(Determinism, reset_starts_from_the_very_beginning) {
  Simulation fresh(drifting_cube(), unfiltered()), used(drifting_cube(), unfiltered());
  run(used, 0, 80);
  used.reset();
  EXPECT_EQ(run(fresh, 0, 80), run(used, 0, 80));
}

TEST(Time, bodies_are_at_the_frames_stamp_when_a_frame_has_been_taken) {
  Simulation simulation(drifting_cube(), unfiltered());
  simulation.advance({at(0.0), {}});
  simulation.advance({at(0.0173), {}});
  simulation.advance({at(0.1), {}});
  EXPECT_NEAR(simulation.state().bodies[0].pose.position.x(), 0.01 * 0.1, 1e-15);
  EXPECT_EQ(simulation.result().stamp, at(0.1));
}

int steps_of_a_frame(Simulation& simulation, const Hand& hand) {
  simulation.advance({at(0.0), {hand}});
  EXPECT_EQ(simulation.begin({at(0.0101), {hand}}), Rejection::none);
  int steps = 0;
  while (simulation.step()) ++steps;
  simulation.end();
  return steps;
}

Configuration steps_of_two_milliseconds() {
  Configuration configuration = unfiltered();
  configuration.step = 0.002;
  return configuration;
}

TEST(Time, no_step_is_longer_than_the_configured_one_where_something_is_near) {
  Simulation simulation(drifting_cube(), steps_of_two_milliseconds());
  EXPECT_EQ(steps_of_a_frame(simulation, pushing(0.2)), 6);
}

// The flight is of fourth order, so that one long step and six short ones differ by 1e-9 of what was turned.
TEST(Time, a_frame_in_which_nothing_is_near_is_one_step_that_ends_at_the_same_place) {
  Simulation far(drifting_cube(), steps_of_two_milliseconds()),
      near(drifting_cube(), steps_of_two_milliseconds());
  const Vector3 beside(0.0, 0.0, 0.045), away(0.0, 0.0, 0.3), along(0.0, 0.02, 0.0);
  EXPECT_EQ(steps_of_a_frame(near, finger(beside, beside + along, 0.008)), 6);
  EXPECT_EQ(steps_of_a_frame(far, finger(away, away + along, 0.008)), 1);
  const Pose& a = far.state().bodies[0].pose;
  const Pose& b = near.state().bodies[0].pose;
  EXPECT_LE((a.position - b.position).norm(), 1e-15);
  EXPECT_LE(a.orientation.angularDistance(b.orientation), 1e-11);
}

TEST(Time, a_repeated_or_earlier_stamp_is_refused_and_changes_nothing) {
  Simulation simulation(drifting_cube(), unfiltered());
  run(simulation, 0, 50);
  const std::uint64_t before = hash(simulation.state());
  const double last = 49 / kTrackerRate;
  for (const double stamp : {last, last - 0.001, last - 0.3, last - 100.0}) {
    EXPECT_EQ(simulation.advance({at(stamp), {pushing(last)}}), Rejection::stamp_not_increasing) << stamp;
    EXPECT_EQ(hash(simulation.state()), before) << stamp;
  }
  EXPECT_EQ(simulation.advance({at(50 / kTrackerRate), {pushing(last)}}), Rejection::none);
}

TEST(Time, a_lone_frame_from_the_future_or_the_past_is_left_out) {
  for (const double off : {0.4, 5.0, 3600.0, -0.7, -5.0}) {
    Simulation disturbed(drifting_cube(), unfiltered()), calm(drifting_cube(), unfiltered());
    run(calm, 0, 100);
    run(disturbed, 0, 50);
    for (int i = 50; i < 100; ++i) {
      const double t = i / kTrackerRate;
      if (i % 7 == 0) {
        EXPECT_NE(disturbed.advance({at(t + off), {pushing(t)}}), Rejection::none) << off;
      }
      EXPECT_EQ(disturbed.advance({at(t), {pushing(t)}}), Rejection::none) << off;
      EXPECT_FALSE(disturbed.result().restarted) << off;
    }
    EXPECT_EQ(hash(disturbed.state()), hash(calm.state())) << off;
  }
}

TEST(Time, a_gap_costs_the_first_frame_after_it_alone) {
  Simulation simulation(drifting_cube(), unfiltered());
  run(simulation, 0, 50);
  EXPECT_EQ(simulation.advance({at(12.0), {}}), Rejection::stamp_ahead);
  EXPECT_EQ(simulation.advance({at(12.01), {}}), Rejection::none);
  EXPECT_FALSE(simulation.result().restarted);
  EXPECT_EQ(simulation.state().time, at(12.01));
  // The gap is no interval of the stream: what is far ahead is still left out.
  EXPECT_EQ(simulation.advance({at(15.0), {}}), Rejection::stamp_ahead);
  EXPECT_EQ(simulation.advance({at(12.02), {}}), Rejection::none);
}

TEST(Time, a_stream_of_a_frame_a_minute_is_taken_from_its_third_frame) {
  Simulation simulation(drifting_cube(), unfiltered());
  int taken = 0;
  for (int i = 0; i < 10; ++i) taken += simulation.advance({at(60.0 * i), {}}) == Rejection::none;
  EXPECT_EQ(taken, 9);
}

TEST(Time, a_slow_stream_may_miss_three_frames_and_what_is_farther_ahead_is_left_out) {
  Simulation simulation(drifting_cube(), unfiltered());
  for (int i = 0; i < 10; ++i)
    EXPECT_EQ(simulation.advance({at(i), {}}), i == 1 ? Rejection::stamp_ahead : Rejection::none) << i;
  EXPECT_EQ(simulation.advance({at(14.1), {}}), Rejection::stamp_ahead);
  EXPECT_EQ(simulation.advance({at(13.0), {}}), Rejection::none) << "four intervals after the last";
}

TEST(Time, a_stamp_that_is_none_is_refused_and_the_next_frame_is_taken) {
  const Nanoseconds second = 1'000'000'000, longest = std::numeric_limits<Nanoseconds>::max();
  for (const Nanoseconds stamp : {4'294'967'295 * second, 4'000'000'000 * second, longest, -longest - 1}) {
    Simulation fresh(drifting_cube(), unfiltered()), running(drifting_cube(), unfiltered());
    EXPECT_EQ(fresh.advance({stamp, {}}), Rejection::no_stamp);
    EXPECT_EQ(fresh.advance({at(0.0), {}}), Rejection::none);
    run(running, 0, 50);
    EXPECT_EQ(running.advance({stamp, {}}), Rejection::no_stamp);
    EXPECT_EQ(running.advance({at(50 / kTrackerRate), {}}), Rejection::none);
  }
}

/// Under UndefinedBehaviorSanitizer this tells an overflow.
TEST(Time, stamps_of_both_ends_of_what_a_stamp_can_be_are_told_apart) {
  const Nanoseconds late = StampCheck::kLatest - 1'000'000'000, step = 10'000'000;
  Simulation simulation(drifting_cube(), unfiltered());
  EXPECT_EQ(simulation.advance({-late, {}}), Rejection::none);
  EXPECT_EQ(simulation.advance({-late + step, {}}), Rejection::none);
  EXPECT_EQ(simulation.advance({late, {}}), Rejection::stamp_ahead);
  EXPECT_EQ(simulation.advance({late + step, {}}), Rejection::none);
  EXPECT_EQ(simulation.advance({late + 2 * step, {}}), Rejection::none);
}

TEST(Time, a_clock_that_tells_what_none_can_does_no_harm) {
  constexpr Nanoseconds kMost = std::numeric_limits<Nanoseconds>::max();
  Simulation simulation(drifting_cube(), unfiltered());
  run(simulation, 0, 50);
  const std::uint64_t before = hash(simulation.state());
  for (const Nanoseconds now : {kMost, -kMost - 1}) {
    EXPECT_FALSE(simulation.advance_without_hands(now));
    EXPECT_EQ(simulation.begin({at(49 / kTrackerRate), {}}, now), Rejection::stamp_not_increasing);
    EXPECT_EQ(hash(simulation.state()), before);
  }
  EXPECT_EQ(simulation.begin({at(0.9), {}}, -kMost - 1), Rejection::stamp_ahead);
}

TEST(Time, a_stream_that_begins_anew_restarts_everything_at_its_third_frame) {
  Simulation simulation(drifting_cube(), unfiltered()), fresh(drifting_cube(), unfiltered());
  run(simulation, 100, 200);
  EXPECT_EQ(simulation.advance({at(0 / kTrackerRate), {pushing(0)}}), Rejection::stamp_not_increasing);
  EXPECT_EQ(simulation.advance({at(1 / kTrackerRate), {pushing(0)}}), Rejection::stamp_not_increasing);
  EXPECT_EQ(simulation.advance({at(2 / kTrackerRate), {pushing(2 / kTrackerRate)}}), Rejection::none);
  EXPECT_TRUE(simulation.result().restarted);
  run(fresh, 2, 3);
  EXPECT_EQ(run(simulation, 3, 50), run(fresh, 3, 50));
  EXPECT_FALSE(simulation.result().restarted);
}

TEST(Time, a_report_before_the_end_has_all_but_the_rendered_hands_and_changes_no_bit) {
  Simulation asked(drifting_cube(), unfiltered()), plain(drifting_cube(), unfiltered());
  run(asked, 0, 60);
  run(plain, 0, 60);
  const HandFrame frame{at(60 / kTrackerRate), {pushing(60 / kTrackerRate)}};
  ASSERT_EQ(asked.begin(frame), Rejection::none);
  while (asked.step()) {
  }
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(asked.report().tracked.size(), 1u) << i;
    EXPECT_TRUE(asked.report().rendered.empty()) << i;
  }
  const std::size_t contacts = asked.report().contacts.size();
  EXPECT_EQ(asked.end().rendered.size(), 1u);
  plain.advance(frame);
  EXPECT_EQ(plain.result().contacts.size(), contacts);
  EXPECT_EQ(plain.result().tracked.size(), 1u);
  EXPECT_EQ(hash(asked.state()), hash(plain.state()));
}

TEST(Silence, computed_bit_by_bit_or_in_one_go_it_gives_the_same_bits) {
  for (const double gap : {0.21, 0.5, 1.2345, 3.0}) {
    Simulation replayed(drifting_cube(), unfiltered()), live(drifting_cube(), unfiltered());
    run(replayed, 0, 70);
    run(live, 0, 70);
    const double last = 69 / kTrackerRate;
    for (double t = last; t < last + gap - 0.001; t += 0.0137) live.advance_without_hands(at(t));
    for (Simulation* simulation : {&replayed, &live}) {
      const Nanoseconds now = at(last + gap);  // as a clock says too
      ASSERT_EQ(simulation->begin({now, {pushing(0.0)}}, now), Rejection::none);
      while (simulation->step()) {
      }
      simulation->end();
    }
    EXPECT_EQ(hash(replayed.state()), hash(live.state())) << gap;
  }
}

TEST(Silence, of_more_than_a_minute_is_not_made_up_for) {
  for (const double gap : {50.0, 70.0}) {
    Scene scene = drifting_cube();
    scene.bounds = {Vector3::Constant(-100.0), Vector3::Constant(100.0)};
    Simulation simulation(scene, unfiltered());
    simulation.advance({at(0.0), {}});
    const Vector3 before = simulation.state().bodies[0].pose.position;
    const Nanoseconds now = at(gap);  // as a clock says too
    ASSERT_EQ(simulation.begin({now, {}}, now), Rejection::none);
    while (simulation.step()) {
    }
    simulation.end();
    const double speed = scene.bodies[0].start_twist.linear.norm();
    const double flown = (simulation.state().bodies[0].pose.position - before).norm();
    EXPECT_NEAR(flown, gap < 60.0 ? gap * speed : 0.0, 0.01 * gap * speed) << gap;
  }
}

// A hold_time of 0, and the default of 0.2 s at 4 frames a second. The rate is known from the second frame
// on.
TEST(HoldTime, shorter_than_a_frame_does_not_lose_a_hand_that_is_in_every_frame) {
  for (const auto& [hold_time, rate] : {std::pair{0.0, 120.0}, {0.0, 30.0}, {0.01, 60.0}, {0.2, 4.0}}) {
    Configuration configuration = unfiltered();
    configuration.tracking.hold_time = hold_time;
    Simulation simulation(drifting_cube(), configuration);
    const Hand hand = testing::finger(Vector3(0, 0.5, 0), Vector3(0, 0.5, 0.02), 0.008);
    int lost = 0;
    double t = 0.0;
    for (int i = 0; i < 20; ++i, t += 1.0 / rate) {
      simulation.begin({at(t), {hand}}, at(t));
      while (simulation.step()) {
      }
      for (const Event& event : simulation.end().events) lost += i > 1 && event.kind == EventKind::hand_lost;
      if (i == 0) continue;
      EXPECT_FALSE(simulation.advance_without_hands(at(t + 1.4 / rate))) << rate;
    }
    EXPECT_EQ(lost, 0) << hold_time << " s, " << rate << " Hz";
    EXPECT_TRUE(simulation.advance_without_hands(at(t + std::max(hold_time, 1.0 / rate) + 0.01)));
    EXPECT_TRUE(simulation.result().tracked.empty());
  }
}

TEST(Silence, within_hold_time_nothing_is_computed_ahead_of_the_next_frame) {
  Simulation simulation(drifting_cube(), unfiltered());
  run(simulation, 0, 70);
  const std::uint64_t before = hash(simulation.state());
  EXPECT_FALSE(simulation.advance_without_hands(at(69 / kTrackerRate + 0.15)));
  EXPECT_EQ(hash(simulation.state()), before);
}

TEST(Silence, objects_fly_on_and_the_hand_is_lost_with_its_interactions_ended_first) {
  Simulation simulation(drifting_cube(), unfiltered());
  run(simulation, 0, 70);
  const double x = simulation.state().bodies[0].pose.position.x();
  ASSERT_TRUE(simulation.advance_without_hands(at(69 / kTrackerRate + 1.0)));
  EXPECT_GT(simulation.state().bodies[0].pose.position.x(), x + 0.01);
  const std::vector<Event>& events = simulation.result().events;
  ASSERT_FALSE(events.empty());
  EXPECT_EQ(events.back().kind, EventKind::hand_lost);
  EXPECT_TRUE(std::any_of(events.begin(), events.end(),
                          [](const Event& event) { return event.kind == EventKind::hover_end; }));
}

TEST(Bounds, a_body_that_leaves_is_put_back_where_it_started_with_an_event) {
  Scene scene = drifting_cube();
  scene.bodies[0].start_twist = {Vector3(2.0, 0, 0), Vector3::Zero()};
  Simulation simulation(scene, unfiltered());
  int events = 0;
  for (int i = 0; i < 100; ++i) {
    simulation.advance({at(0.01 * i), {}});
    for (const Event& event : simulation.result().events) events += event.kind == EventKind::out_of_bounds;
    EXPECT_LE(simulation.state().bodies[0].pose.position.x(), scene.bounds.max.x());
  }
  EXPECT_EQ(events, 1);  // 1.98 m flown, bound at 1.5 m
}

TEST(Gravity, the_parameter_goes_before_the_scenes_own) {
  Scene scene = drifting_cube();
  scene.bodies[0].start_twist = {};
  scene.gravity = Vector3(0, 0, -9.81);
  Configuration configuration = unfiltered();
  configuration.gravity = Vector3(0, 0, 1.0);
  Simulation simulation(scene, configuration);
  simulation.advance({at(0.0), {}});
  simulation.advance({at(0.1), {}});
  EXPECT_NEAR(simulation.state().bodies[0].pose.position.z(), 0.5 * 0.01, 1e-15);
}

TEST(StepLength, that_would_never_end_is_refused) {
  for (const double step : {0.0, -0.001, 1e-10, 1e-9, 1e300, std::numeric_limits<double>::quiet_NaN()}) {
    Configuration configuration;
    configuration.step = step;
    EXPECT_THROW(Simulation(Scene(), configuration), std::invalid_argument) << step;
  }
}

}  // namespace
}  // namespace mrhi
