#include <gtest/gtest.h>

#include "mr_hand_interaction/training/trial.h"
#include "synthetic/performance.h"
#include "training/trials.h"

namespace mrhi {
namespace {

/// One run of a scripted motion, and the pause after it, as a trial of a task.
Trial perform_as(const std::string& motion, const Task& task) {
  SyntheticHandOptions options;
  options.motion = motion;
  SyntheticHand source(options);
  const Configuration configuration;
  Simulation simulation(testing::staged_scene(source.motion(), configuration), configuration);
  Trial trial(task);
  while (source.next_run() == 0) {
    const JointsFrame joints = source.next();
    HandFrame frame{joints.stamp, {}};
    for (const HandJoints& hand : joints.hands)
      frame.hands.push_back(complete_hand(hand, default_device_mount()));
    EXPECT_EQ(Rejection::none, simulation.advance(frame));
    trial.update(observe(simulation, 0));
  }
  return trial;
}

TEST(ScriptedTrial, grasp_cube_goes_through_all_stages) {
  const Task task = load_task("test/ros/training_carry.yaml");
  const Trial trial = perform_as("grasp_cube", task);
  EXPECT_EQ(TrialResult::completed, trial.result());
  const TrialMeasures& measures = trial.measures();
  EXPECT_EQ(1, measures.attempts);
  EXPECT_EQ(0, measures.drops);
  EXPECT_NEAR(0.08, measures.path_length, 0.005) << "the way that the script carries it, in a straight line";
  ASSERT_TRUE(measures.grip_force_mean && measures.release_drift && measures.release_speed);
  EXPECT_GT(*measures.grip_force_mean, 0.05);
  EXPECT_GT(*measures.grip_force_max, *measures.grip_force_mean);
  EXPECT_NEAR(*measures.release_speed * task.goals.back().drift_time, *measures.release_drift, 1e-3)
      << "nothing acts on what flies";
}

}  // namespace
}  // namespace mrhi
