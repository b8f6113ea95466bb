#include <cmath>
#include <tuple>

#include "training/trials.h"

namespace mrhi {
namespace {

using test::Feeder;

Task of(const Goal& goal) {
  Task task = test::two_places();
  task.goals = {goal};
  return task;
}

Quaternion tilt(double degrees) {
  return Quaternion(Eigen::AngleAxisd(degrees * M_PI / 180.0, Vector3::UnitX()));
}

TEST(Insert, asks_for_the_axis_either_way_round) {
  Goal goal = test::place(Vector3::Zero());
  goal.kind = GoalKind::insert;
  goal.angle_tolerance = 10.0 * M_PI / 180.0;
  goal.axis = Vector3::UnitZ();
  const Task task = of(goal);
  const Quaternion turned(Eigen::AngleAxisd(1.0, Vector3::UnitZ()));
  for (const auto& [orientation, met] : {std::pair{tilt(9), true}, std::pair{tilt(11), false},
                                         std::pair{tilt(171), true}, std::pair{turned, true}}) {
    Feeder feeder(task);
    feeder.seen.pose.orientation = orientation;
    feeder.held(true);
    EXPECT_EQ(met, feeder.trial.inside()) << orientation.coeffs().transpose();
  }
}

TEST(Place, asks_for_the_whole_orientation_where_no_axis_is_given) {
  Goal goal = test::place(Vector3::Zero());
  goal.orientation = tilt(90);
  goal.angle_tolerance = 10.0 * M_PI / 180.0;
  const Task task = of(goal);
  for (const auto& [degrees, met] : {std::pair{95.0, true}, std::pair{101.0, false}, std::pair{0.0, false}}) {
    Feeder feeder(task);
    feeder.seen.pose.orientation = tilt(degrees);
    feeder.held(true);
    EXPECT_EQ(met, feeder.trial.inside()) << degrees;
  }
}

Goal joint_goal(double above, double below) {
  Goal goal;
  goal.kind = GoalKind::joint;
  goal.joint = "hinge";
  goal.above = above;
  goal.below = below;
  return goal;
}

TEST(JointGoal, is_reached_between_its_bounds_and_by_its_joint_alone) {
  const Task task = of(joint_goal(0.5, 1.0));
  for (const auto& [name, place, met] :
       {std::tuple{"hinge", 0.4, false}, std::tuple{"hinge", 0.5, true}, std::tuple{"hinge", 1.0, true},
        std::tuple{"hinge", 1.1, false}, std::tuple{"rail", 0.7, false}}) {
    Feeder feeder(task);
    feeder.seen.joints = {{"other", 0.7}, {name, place}};
    feeder.step();
    EXPECT_EQ(feeder.trial.result(), met ? TrialResult::completed : TrialResult::none)
        << name << " " << place;
  }
}

TEST(JointGoal, has_its_time_from_the_goal_before_on) {
  Task task = of(joint_goal(0.5, 2.0));
  task.goals.push_back(joint_goal(-1.0, 0.1));
  task.goals.back().within = 2.0;
  Feeder late(task), in_time(task);
  late.seen.joints = in_time.seen.joints = {{"hinge", 0.0}};
  late.stay(5.0), in_time.stay(5.0);
  late.seen.joints = in_time.seen.joints = {{"hinge", 1.0}};
  late.stay(2.2), in_time.stay(1.8);
  EXPECT_EQ(late.trial.result(), TrialResult::timed_out);
  in_time.seen.joints = {{"hinge", 0.0}};
  in_time.step();
  EXPECT_EQ(in_time.trial.result(), TrialResult::completed);
  EXPECT_EQ(in_time.count(TrialEventKind::goal_achieved), 2);
}

Goal catch_goal() {
  Goal goal;
  goal.kind = GoalKind::catch_it;
  goal.within = 4.0;
  goal.hold = 1.0;
  return goal;
}

TEST(Catch, is_done_when_what_was_caught_in_time_has_been_held) {
  const Task task = of(catch_goal());
  Feeder feeder(task);
  feeder.stay(3.9).held(true).stay(0.9);
  EXPECT_EQ(TrialResult::none, feeder.trial.result());
  feeder.stay(0.1);
  EXPECT_EQ(TrialResult::completed, feeder.trial.result());
}

TEST(Catch, is_over_when_nothing_was_caught_in_time) {
  const Task task = of(catch_goal());
  Feeder feeder(task);
  feeder.stay(4.1);
  EXPECT_EQ(TrialResult::timed_out, feeder.trial.result());
}

TEST(Catch, may_be_dropped_and_taken_again) {
  const Task task = of(catch_goal());
  Feeder feeder(task);
  feeder.stay(3.0).held(true).stay(0.5).held(false).stay(3.0).held(true).stay(1.0);
  EXPECT_EQ(TrialResult::completed, feeder.trial.result());
  EXPECT_EQ(1, feeder.trial.measures().drops);
}

TEST(NudgeInto, asks_for_rest_in_the_box_without_a_grasp) {
  Goal goal;
  goal.kind = GoalKind::nudge_into;
  goal.position = {0.1, 0, 0};
  goal.size = {0.1, 0.1, 0.1};
  goal.max_speed = 0.02;
  goal.hold = 0.5;
  const Task task = of(goal);
  Feeder feeder(task);
  feeder.seen.touched = true;
  feeder.seen.twist.linear.x() = 0.1;
  feeder.at({0.04, 0, 0});
  feeder.seen.touched = false;
  feeder.at({0.06, 0, 0}).stay(1.0);
  EXPECT_FALSE(feeder.trial.inside()) << "too fast";
  feeder.seen.twist.linear.x() = 0.01;
  feeder.held(true).stay(1.0);
  EXPECT_FALSE(feeder.trial.inside()) << "held";
  feeder.held(false).at({0.045, 0, 0});
  EXPECT_FALSE(feeder.trial.inside()) << "5 mm outside: half of the size is to each side";
  feeder.at({0.06, 0, 0}).stay(0.5);
  EXPECT_EQ(TrialResult::completed, feeder.trial.result());
  EXPECT_EQ(1, feeder.trial.measures().attempts) << "touched once";
  EXPECT_EQ(0, feeder.trial.measures().drops) << "letting go is what is asked for";
}

TEST(Strike, is_judged_by_the_speed_with_which_the_object_leaves) {
  Goal goal;
  goal.kind = GoalKind::strike;
  goal.min_speed = 0.05;
  goal.max_speed = 0.1;
  const Task task = of(goal);
  for (const auto& [speed, done] : {std::pair{0.04, false}, std::pair{0.07, true}, std::pair{0.2, false}}) {
    Feeder feeder(task);
    feeder.stay(0.5);
    feeder.seen.touched = true;
    feeder.seen.twist.linear.x() = 0.07;  // in the hand it may have any speed
    feeder.stay(0.05);
    EXPECT_EQ(TrialResult::none, feeder.trial.result());
    feeder.seen.touched = false;
    feeder.seen.twist.linear.x() = speed;
    feeder.stay(0.05);
    EXPECT_EQ(TrialResult::none, feeder.trial.result()) << "it may be touched again at once";
    feeder.stay(0.1);
    EXPECT_EQ(done ? TrialResult::completed : TrialResult::none, feeder.trial.result()) << speed;
    EXPECT_EQ(done ? 0 : 1, feeder.count(TrialEventKind::missed)) << speed;
    EXPECT_EQ(1, feeder.trial.measures().attempts) << speed;
  }
}

}  // namespace
}  // namespace mrhi
