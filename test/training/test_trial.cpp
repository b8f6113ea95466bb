#include "training/trials.h"

namespace mrhi {
namespace {

using test::Feeder;
using test::kAway;
using test::kFirst;
using test::kFrame;
using test::kSecond;

TEST(Trial, goes_from_picking_up_over_the_places_to_the_release) {
  const Task task = test::two_places();
  Feeder feeder(task);
  feeder.stay(1.0);
  EXPECT_EQ(TrainingStage::manipulation, feeder.trial.stage());
  feeder.held(true).at({0.04, 0, 0});
  EXPECT_EQ(0u, feeder.trial.goal()) << "not yet lifted by 5 cm";
  feeder.at({0.06, 0, 0});
  EXPECT_EQ(TrainingStage::maintenance, feeder.trial.stage());
  feeder.at(kFirst).stay(3.0);
  EXPECT_EQ(2u, feeder.trial.goal());
  feeder.at(kSecond).stay(3.0);
  EXPECT_EQ(TrainingStage::release, feeder.trial.stage());
  feeder.held(false);
  EXPECT_EQ(TrialResult::none, feeder.trial.result()) << "its drift is still to be seen";
  feeder.stay(2.0);
  EXPECT_EQ(TrialResult::completed, feeder.trial.result());
  EXPECT_EQ(0.0, feeder.trial.remaining());
  EXPECT_EQ(1.0, feeder.trial.progress());

  const TrialMeasures& measures = feeder.trial.measures();
  EXPECT_NEAR(1.0 + 0.03 + 3.01 + 3.01 + 0.01, measures.completion_time, 2 * kFrame);
  EXPECT_NEAR(1.02, *measures.stage_times[0], kFrame);
  EXPECT_NEAR(6.02, *measures.stage_times[1], kFrame);
  EXPECT_NEAR(0.01, *measures.stage_times[2], kFrame);
  EXPECT_EQ(1, measures.attempts);
  EXPECT_EQ(0, measures.drops);
}

TEST(Trial, timer_runs_while_the_object_is_inside_and_held) {
  const Task task = test::two_places();
  Feeder feeder(task);
  feeder.held(false).held(true).at({0.06, 0, 0}).at(kFirst);
  EXPECT_TRUE(feeder.trial.inside());
  feeder.stay(1.5);
  EXPECT_NEAR(0.5, feeder.trial.progress(), 1e-9);
  EXPECT_NEAR(1.5, feeder.trial.remaining(), 1e-9);
}

TEST(Trial, timer_begins_anew_when_the_place_has_been_left) {
  const Task task = test::two_places();
  Feeder feeder(task);
  feeder.held(false).held(true).at({0.06, 0, 0}).at(kFirst).stay(2.9).at(kAway);
  EXPECT_FALSE(feeder.trial.inside());
  EXPECT_EQ(0.0, feeder.trial.progress());
  feeder.at(kFirst).stay(2.9);
  EXPECT_EQ(1u, feeder.trial.goal());
  feeder.stay(0.1);
  EXPECT_EQ(2u, feeder.trial.goal());
}

TEST(Trial, timer_goes_on_where_it_stopped_if_the_task_says_so) {
  Task task = test::two_places();
  task.goals[1] = test::place(kFirst, Leaving::stop);
  Feeder feeder(task);
  feeder.held(false).held(true).at({0.06, 0, 0}).at(kFirst).stay(2.0).at(kAway).stay(5.0);
  EXPECT_NEAR(1.0, feeder.trial.remaining(), 1e-9) << "nothing runs outside";
  feeder.at(kFirst).stay(0.9);
  EXPECT_EQ(1u, feeder.trial.goal());
  feeder.stay(0.1);
  EXPECT_EQ(2u, feeder.trial.goal());
}

TEST(Trial, timer_stops_when_the_object_is_dropped_inside) {
  const Task task = test::two_places();
  Feeder feeder(task);
  feeder.held(false).held(true).at({0.06, 0, 0}).at(kFirst).stay(2.0).held(false).stay(5.0);
  EXPECT_EQ(1u, feeder.trial.goal());
  EXPECT_EQ(1, feeder.trial.measures().drops);
  feeder.held(true).stay(3.0);
  EXPECT_EQ(2u, feeder.trial.goal());
  EXPECT_EQ(2, feeder.trial.measures().attempts);
}

TEST(Trial, tolerance_is_met_to_its_rim) {
  const Task task = test::two_places();
  for (const double off : {0.0299, 0.0301}) {
    Feeder feeder(task);
    feeder.held(false).held(true).at({0.06, 0, 0}).at(kFirst + Vector3(0, 0, off));
    EXPECT_EQ(off < 0.03, feeder.trial.inside()) << off;
  }
}

TEST(Trial, every_drop_before_the_release_counts_and_the_release_does_not) {
  const Task task = test::two_places();
  Feeder feeder(task);
  feeder.held(false).held(true).held(false).stay(0.1).held(true).at({0.06, 0, 0}).held(false).stay(0.1);
  feeder.held(true);
  feeder.at(kFirst).stay(3.0).at(kSecond).stay(3.0).held(false).stay(2.0);
  EXPECT_EQ(TrialResult::completed, feeder.trial.result());
  EXPECT_EQ(3, feeder.trial.measures().attempts);
  EXPECT_EQ(2, feeder.trial.measures().drops);
  EXPECT_EQ(2, feeder.count(TrialEventKind::dropped));
  EXPECT_EQ(1, feeder.count(TrialEventKind::released));
}

TEST(Trial, a_grasp_that_is_there_again_within_a_tenth_of_a_second_has_dropped_nothing) {
  const Task task = test::two_places();
  for (const double gap : {0.09, 0.11}) {
    Feeder feeder(task);
    feeder.held(false).held(true).at({0.06, 0, 0}).held(false).stay(gap - 0.01).held(true).stay(1.0);
    EXPECT_EQ(gap < 0.1 ? 0 : 1, feeder.trial.measures().drops) << gap;
    EXPECT_EQ(gap < 0.1 ? 1 : 2, feeder.trial.measures().attempts) << gap;
  }
}

TEST(Trial, what_is_put_back_was_dropped) {
  const Task task = test::two_places();
  Feeder feeder(task);
  feeder.held(false).held(true).at({0.06, 0, 0});
  feeder.seen.put_back = true;
  feeder.held(false);
  EXPECT_EQ(1, feeder.trial.measures().drops);
}

Feeder at_the_release(const Task& task) {
  Feeder feeder(task);
  feeder.held(false).held(true).at({0.06, 0, 0}).at(kFirst).stay(3.0).at(kSecond).stay(3.0);
  return feeder;
}

TEST(Trial, release_drift_is_the_way_over_two_seconds_whatever_the_rate) {
  const Task task = test::two_places();
  const Vector3 velocity(0.01, 0.02, 0.0);
  for (const double period : {0.01, 0.03, 0.13}) {
    Feeder feeder = at_the_release(task);
    feeder.seen.held = false;
    feeder.seen.twist.linear = velocity;
    for (int i = 0; i <= static_cast<int>(2.0 / period) + 1; ++i) {
      feeder.seen.stamp += static_cast<Nanoseconds>(1e9 * period + 0.5);
      feeder.seen.pose.position = kSecond + i * period * velocity;
      feeder.trial.update(feeder.seen);
    }
    ASSERT_EQ(TrialResult::completed, feeder.trial.result()) << period;
    EXPECT_NEAR(2.0 * velocity.norm(), *feeder.trial.measures().release_drift, 1e-9) << period;
    EXPECT_NEAR(velocity.norm(), *feeder.trial.measures().release_speed, 1e-12);
  }
}

TEST(Trial, what_is_taken_again_was_not_let_go) {
  const Task task = test::two_places();
  Feeder feeder = at_the_release(task);
  feeder.held(false).stay(1.0).held(true).stay(1.5);
  EXPECT_EQ(TrialResult::none, feeder.trial.result());
  feeder.held(false).stay(2.0);
  EXPECT_EQ(TrialResult::completed, feeder.trial.result());
  const TrialMeasures& measures = feeder.trial.measures();
  const double stages = *measures.stage_times[0] + *measures.stage_times[1] + *measures.stage_times[2];
  EXPECT_NEAR(measures.completion_time, stages, 1e-9);
}

TEST(Trial, times_out_and_says_how_far_it_got) {
  Task task = test::two_places();
  task.time_out = 10.0;
  Feeder feeder(task);
  feeder.held(false).held(true).at({0.06, 0, 0}).stay(9.8);
  EXPECT_EQ(TrialResult::none, feeder.trial.result());
  feeder.stay(0.3);
  EXPECT_EQ(TrialResult::timed_out, feeder.trial.result());
  EXPECT_NEAR(10.0, feeder.trial.measures().completion_time, kFrame);
  EXPECT_TRUE(feeder.trial.measures().stage_times[1]);
  EXPECT_FALSE(feeder.trial.measures().stage_times[2]);
}

TEST(Trial, time_while_paused_does_not_count) {
  Task task = test::two_places();
  task.time_out = 10.0;
  Feeder feeder(task);
  feeder.held(false).held(true).at({0.06, 0, 0}).at(kFirst).stay(1.0);
  const double before = feeder.trial.elapsed(), remaining = feeder.trial.remaining();
  feeder.trial.pause();
  feeder.seen.stamp += 100'000'000'000;
  feeder.step();
  EXPECT_EQ(TrialResult::none, feeder.trial.result());
  EXPECT_EQ(before, feeder.trial.elapsed());
  EXPECT_EQ(remaining, feeder.trial.remaining());
  feeder.step();
  EXPECT_NEAR(before + 0.01, feeder.trial.elapsed(), 1e-12);
}

TEST(Trial, stamps_that_do_not_grow_are_passed_over) {
  const Task task = test::two_places();
  Feeder feeder(task);
  feeder.stay(1.0);
  const double elapsed = feeder.trial.elapsed();
  feeder.seen.held = true;
  feeder.trial.update(feeder.seen);
  feeder.seen.stamp -= 500'000'000;
  feeder.trial.update(feeder.seen);
  EXPECT_EQ(elapsed, feeder.trial.elapsed());
  EXPECT_EQ(0, feeder.trial.measures().attempts);
}

TEST(Trial, measures_path_and_grip_while_held_only) {
  const Task task = test::two_places();
  Feeder feeder(task);
  feeder.seen.grip_force = 9.0;
  feeder.held(false).at({0, 0, 0.5}).at({0, 0, 0});
  feeder.seen.grip_force = 1.0;
  feeder.held(true).at({0, 0.03, 0}).at({0.04, 0.03, 0});
  feeder.seen.grip_force = 4.0;
  feeder.step();
  feeder.seen.grip_force.reset();
  feeder.stay(1.0);
  feeder.trial.end(TrialResult::skipped);
  EXPECT_NEAR(0.07, feeder.trial.measures().path_length, 1e-12);
  EXPECT_NEAR((1.0 + 1.0 + 4.0) / 3.0, *feeder.trial.measures().grip_force_mean, 1e-9);
  EXPECT_EQ(4.0, *feeder.trial.measures().grip_force_max);
  EXPECT_EQ(TrialResult::skipped, feeder.trial.result());
}

TEST(Trial, counts_lost_hands) {
  const Task task = test::two_places();
  Feeder feeder(task);
  feeder.seen.tracking_losses = 2;
  feeder.step();
  feeder.seen.tracking_losses = 0;
  feeder.stay(1.0);
  EXPECT_EQ(2, feeder.trial.measures().tracking_losses);
}

TEST(Trial, copy_goes_its_own_way_with_the_same_bits) {
  const Task task = test::two_places();
  Feeder one = at_the_release(task);
  Feeder two = one;
  one.held(false).stay(2.0);
  EXPECT_EQ(TrialResult::none, two.trial.result());
  two.held(false).stay(2.0);
  EXPECT_EQ(one.trial.measures().completion_time, two.trial.measures().completion_time);
  EXPECT_EQ(one.trial.measures().path_length, two.trial.measures().path_length);
  EXPECT_EQ(one.events.size(), two.events.size());
}

}  // namespace
}  // namespace mrhi
