#include "mr_hand_interaction/replay/recording_csv.h"
#include "mr_hand_interaction/scene/scene_loader.h"
#include "mr_hand_interaction/tracking/joints.h"
#include "rendering/expect_one_hand.h"
#include "support/recordings.h"

namespace mrhi {
namespace {

using testing::RenderedCheck;

const Pose kDeskMount{Vector3::Zero(), Quaternion(Eigen::AngleAxisd(0.5 * M_PI, Vector3::UnitX()))};

std::vector<HandFrame> frames_of(const std::string& file) {
  std::vector<HandFrame> frames;
  std::vector<std::string> defects;
  for (const JointsFrame& joints : read_recording_csv(file)) {
    std::optional<HandFrame> frame = complete_frame(joints, kDeskMount, defects);
    if (frame) frames.push_back(std::move(*frame));
  }
  return frames;
}

Scene shipped_scene(const std::string& name) {
  SceneOptions options;
  options.default_material = default_material(Configuration());
  return load_scene("config/scenes/" + name + ".urdf", options);
}

// These hands know nothing of the bodies and are flung through them, at up to 50 mm a frame. A finger that a
// rail catches near its root swings at the tip, and a hand that is caught between two bodies is shifted out.
constexpr double kFarthestJump = 0.02;  // [m]
constexpr int kFramesPerJump = 500;     // with the hand held aside

class RenderedRecording : public ::testing::TestWithParam<const char*> {
 protected:
  static Scene scene(const std::vector<HandFrame>& frames) {
    const std::string name = GetParam();
    return name == "in_the_way" ? testing::scene_in_the_way(frames) : shipped_scene(name);
  }
};

TEST_P(RenderedRecording, is_one_hand_outside_everything) {
  const std::vector<std::string> files = testing::recordings();
  MRHI_NEED_RECORDINGS(files);
  int moved_aside = 0, frames_aside = 0, jumps = 0;
  for (const std::string& file : files) {
    const std::vector<HandFrame> frames = frames_of(file);
    const RenderedCheck check = testing::render_all(scene(frames), frames);
    moved_aside += check.moved_aside > 0;
    testing::expect_one_hand(check, file, kFarthestJump);
    frames_aside += check.moved_aside;
    jumps += check.jumps;
  }
  EXPECT_LE(jumps * kFramesPerJump, frames_aside) << jumps << " jumps";
  // Half of them at least must have been kept out of something, or the test would say nothing.
  if (GetParam() == std::string("in_the_way")) {
    EXPECT_GE(2 * moved_aside, static_cast<int>(files.size()));
  }
}

INSTANTIATE_TEST_SUITE_P(Scene, RenderedRecording, ::testing::Values("in_the_way", "mixed", "rack"),
                         [](const auto& tested) { return std::string(tested.param); });

}  // namespace
}  // namespace mrhi
