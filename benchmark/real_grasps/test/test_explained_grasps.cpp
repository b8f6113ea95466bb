// Whether what an explanation says of people's grasps is so: what it says was missing is given, and the body
// then stays in the hand for longer.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "../closing.h"
#include "../trial.h"
#include "mr_hand_interaction/response/contact_model.h"
#include "replay/explain.h"
#include "support/recordings.h"

namespace mrhi::real_grasps {
namespace {

constexpr double kLonger = 0.1;      // that counts as held for longer [s]
constexpr double kFilterLag = 0.04;  // of what the explanation sees, which is filtered, at the most [s]

struct Setting {
  Row row;
  double friction;
  bool help;
};

Simulation simulation_of(const Setting& setting, const Closing& closing) {
  Configuration configuration;
  configuration.contact.grasp_assist = setting.help;
  Material material = default_material(configuration);
  material.static_friction = setting.friction;
  material.dynamic_friction = 0.75 * setting.friction;
  Scene scene;
  scene.bounds = {Vector3::Constant(-1e3), Vector3::Constant(1e3)};
  scene.bodies.push_back(body_of(setting.row, closing.place, material));
  return Simulation(std::move(scene), configuration);
}

Explanation explained(const std::vector<JointsFrame>& frames, const Closing& closing,
                      const Setting& setting) {
  Simulation simulation = simulation_of(setting, closing);
  Explainer explainer;
  std::vector<std::string> left_out;
  for (const JointsFrame& joints : frames) {
    const auto frame = complete_frame(joints, device_mount(), left_out);
    if (frame && simulation.advance(*frame) == Rejection::none) explainer.watch(simulation);
  }
  return explainer.explain("");
}

HandJoints* hand_in(JointsFrame& frame, std::uint32_t id) {
  for (HandJoints& hand : frame.hands)
    if (hand.id == id) return &hand;
  return nullptr;
}

/// The knuckles, and where the metacarpals begin.
Eigen::Matrix3Xd palm_of(const HandJoints& hand) {
  Eigen::Matrix3Xd points(3, 8);
  for (int finger = 1; finger < kFingers; ++finger)
    for (int joint = 0; joint < 2; ++joint)
      points.col(2 * (finger - 1) + joint) =
          hand.joints[static_cast<std::size_t>(finger)][static_cast<std::size_t>(joint)].value_or(
              Vector3::Zero());
  return points;
}

/// From a time on the fingers keep their places in the palm, which goes on as recorded.
std::vector<JointsFrame> with_fingers_kept(std::vector<JointsFrame> frames, std::uint32_t id, double since) {
  std::optional<HandJoints> kept;
  for (JointsFrame& frame : frames) {
    HandJoints* now = hand_in(frame, id);
    if (now == nullptr) continue;
    if (to_seconds(frame.stamp - frames.front().stamp) < since) {
      kept = *now;
      continue;
    }
    if (!kept) continue;
    const Eigen::Matrix4d moved = Eigen::umeyama(palm_of(*kept), palm_of(*now), false);
    for (std::size_t finger = 0; finger < now->joints.size(); ++finger)
      for (std::size_t joint = 0; joint < 5; ++joint)
        if (kept->joints[finger][joint])
          now->joints[finger][joint] = (moved * kept->joints[finger][joint]->homogeneous()).head<3>();
  }
  return frames;
}

bool touched_at(const Explanation& story, double time) {
  for (const ObjectSample& sample : story.objects.at("placed").samples)
    if (sample.time >= time) return !sample.fingers.empty();
  return true;
}

struct Tally {
  int said = 0, so = 0;
  std::string not_so;
};

/// Of each first loss that a hand is said to have brought about by opening: whether the body stays where its
/// fingers do not open.
void keep_fingers_closed(const Setting& setting, Tally& tally) {
  for (const std::string& file : recording_files({testing::recordings_folder()})) {
    const Recording recording = load_recording(file);
    for (const Closing& closing : closings(recording, setting.row)) {
      const auto frames = disturbed(recording.frames, closing.begin, closing.last, {});
      const Explanation story = explained(frames, closing, setting);
      if (story.losses.empty() || story.losses.front().cause != LossCause::hand_opened) continue;
      const Loss& loss = story.losses.front();
      ++tally.said;
      const auto kept = with_fingers_kept(frames, closing.hand, loss.opened - kFilterLag);
      const bool so = touched_at(explained(kept, closing, setting), loss.until + kLonger);
      tally.so += so;
      if (!so) tally.not_so += recording.name + ": " + loss.text + "\n";
    }
  }
}

// 36 of 36 and 27 of 29. Where it is not so, fingers went through the body and it is out before they open for
// good.
TEST(ExplainedGrasps, WhatIsLetGoByAHandThatOpensStaysInOneThatDoesNot) {
  MRHI_NEED_RECORDINGS(testing::recordings());
  for (const Setting& setting : {Setting{{"cube", Kind::pinch, false, 0.04, 0.1}, 0.8, true},
                                 Setting{{"sphere", Kind::grab, true, 0.06, 0.1}, 0.8, true}}) {
    Tally tally;
    keep_fingers_closed(setting, tally);
    RecordProperty(setting.row.name + "_so", std::to_string(tally.so) + " of " + std::to_string(tally.said));
    EXPECT_GT(tally.said, 20) << setting.row.name;
    EXPECT_GE(tally.so, 0.9 * tally.said) << setting.row.name << '\n' << tally.not_so;
  }
}

bool slid(const Loss& loss) {
  return loss.cause == LossCause::too_little_friction || loss.cause == LossCause::too_little_force;
}

/// The losses of a setting; of those in which the body slid, whether it stays at 1.2 times the friction told.
void try_friction(const Setting& setting, int& losses, Tally& tally) {
  for (const std::string& file : recording_files({testing::recordings_folder()})) {
    const Recording recording = load_recording(file);
    for (const Closing& closing : closings(recording, setting.row)) {
      const auto frames = disturbed(recording.frames, closing.begin, closing.last, {});
      for (const Loss& loss : explained(frames, closing, setting).losses) {
        ++losses;
        EXPECT_EQ(loss.text.find("inf"), std::string::npos) << loss.text;
        EXPECT_EQ(loss.text.find("nan"), std::string::npos) << loss.text;
        EXPECT_NE(loss.text.find("Last touches: "), std::string::npos) << loss.text;
        if (!slid(loss)) continue;
        ++tally.said;
        Setting other = setting;
        other.friction = 1.2 * std::max(setting.friction, loss.friction_needed);
        tally.so += touched_at(explained(frames, closing, other), loss.until + kLonger);
      }
    }
  }
}

// The friction told is not asserted: recorded hands that let a body slide mostly open as well.
TEST(ExplainedGrasps, EachLossHasItsParagraph) {
  MRHI_NEED_RECORDINGS(testing::recordings());
  int losses = 0;
  Tally tally;
  for (const double friction : {0.1, 0.2, 0.8})
    try_friction({{"cube", Kind::pinch, false, 0.04, 0.1}, friction, false}, losses, tally);
  RecordProperty("friction_so", std::to_string(tally.so) + " of " + std::to_string(tally.said));
  EXPECT_GT(losses, 60);
}

}  // namespace
}  // namespace mrhi::real_grasps
