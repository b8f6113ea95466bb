#include <gtest/gtest.h>

#include "rendering/expect_one_hand.h"
#include "synthetic/performance.h"
#include "training/operator_trial.h"

namespace mrhi {
namespace {

using testing::RenderedCheck;

/// One run of a motion.
std::vector<HandFrame> frames_of(const std::string& motion, const std::string& side) {
  SyntheticHandOptions options;
  options.motion = motion;
  options.side = side;
  SyntheticHand source(options);
  std::vector<HandFrame> frames;
  while (source.next_run() == 0) {
    const JointsFrame joints = source.next();
    frames.push_back({joints.stamp, {}});
    for (const HandJoints& hand : joints.hands)
      frames.back().hands.push_back(complete_hand(hand, default_device_mount()));
  }
  return frames;
}

class RenderedMotion : public ::testing::TestWithParam<std::string> {};

TEST_P(RenderedMotion, is_one_hand_outside_the_objects_of_its_scene) {
  for (const bool on_a_table : {false, true}) {
    const Scene scene =
        testing::staged_scene(make_motion(GetParam()), Configuration(), on_a_table ? stand_under : nullptr);
    testing::expect_one_hand(testing::render_all(scene, frames_of(GetParam(), "right")), GetParam());
  }
}

TEST_P(RenderedMotion, is_one_hand_outside_what_is_put_in_its_way) {
  for (const char* side : {"right", "left"}) {
    const std::vector<HandFrame> frames = frames_of(GetParam(), side);
    const RenderedCheck check = testing::render_all(testing::scene_in_the_way(frames), frames);
    EXPECT_GT(check.moved_aside, 20);
    testing::expect_one_hand(check, GetParam() + " " + side);
  }
}

INSTANTIATE_TEST_SUITE_P(All, RenderedMotion, ::testing::ValuesIn(motion_names()),
                         [](const auto& tested) { return tested.param; });

}  // namespace
}  // namespace mrhi
