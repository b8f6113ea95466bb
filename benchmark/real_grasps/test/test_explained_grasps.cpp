// Checks explanations of people's grasps: the force that an explanation reports as missing is added, and the
// body then stays in the hand longer.
#include <gtest/gtest.h>

#include <yaml-cpp/yaml.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "../closing.h"
#include "../trial.h"
#include "mr_hand_interaction/response/contact_model.h"
#include "replay/replay_files.h"
#include "replay/run.h"
#include "support/recordings.h"

namespace mrhi::real_grasps {
namespace {

constexpr double kLonger = 0.1;      // minimum gain of holding time [s]
constexpr double kFilterLag = 0.04;  // maximum lag of the explanation, whose input is filtered [s]

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

/// Calls `watch` after each frame.
void play(const std::vector<JointsFrame>& frames, Simulation& simulation,
          const std::function<void(const Simulation&)>& watch) {
  std::vector<std::string> left_out;
  for (const JointsFrame& joints : frames) {
    const auto frame = complete_frame(joints, device_mount(), left_out);
    if (frame && simulation.advance(*frame) == Rejection::none) watch(simulation);
  }
}

/// Runs in separate folders, as replay writes them, explained together.
class Runs {
 public:
  void add(const std::vector<JointsFrame>& frames, const Closing& closing, const Setting& setting) {
    Simulation simulation = simulation_of(setting, closing);
    ReplayArguments arguments;
    arguments.output = name(count_++);
    ReplayRun run(arguments, "");
    run.begin(simulation, "placed");
    play(frames, simulation, [&](const Simulation& now) {
      run.result(now);
      ++run.summary.frames;
    });
    run.check_end();
    run.end(simulation, "");
  }

  /// Losses of each run, from explain.json.
  std::vector<YAML::Node> losses() const {
    const std::string command =
        "/usr/bin/python3 benchmark/real_grasps/test/explain_all.py " + (folder_ / "runs");
    EXPECT_EQ(0, std::system(command.c_str()));
    std::vector<YAML::Node> losses;
    for (std::size_t i = 0; i < count_; ++i) losses.push_back(YAML::LoadFile(name(i) + "/losses.json"));
    return losses;
  }

 private:
  std::string name(std::size_t i) const { return folder_ / ("runs/" + std::to_string(i)); }

  test::Folder folder_;
  std::size_t count_ = 0;
};

HandJoints* hand_in(JointsFrame& frame, std::uint32_t id) {
  for (HandJoints& hand : frame.hands)
    if (hand.id == id) return &hand;
  return nullptr;
}

/// Knuckles, and carpal ends of the metacarpals.
Eigen::Matrix3Xd palm_of(const HandJoints& hand) {
  Eigen::Matrix3Xd points(3, 8);
  for (int finger = 1; finger < kFingers; ++finger)
    for (int joint = 0; joint < 2; ++joint)
      points.col(2 * (finger - 1) + joint) =
          hand.joints[static_cast<std::size_t>(finger)][static_cast<std::size_t>(joint)].value_or(
              Vector3::Zero());
  return points;
}

/// From `since` on the fingers keep their pose in the palm, which moves as recorded.
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

/// True if the body is touched at the first frame from `time` on, or if the recording ends before.
bool touched_at(double time, const std::vector<JointsFrame>& frames, const Closing& closing,
                const Setting& setting) {
  Simulation simulation = simulation_of(setting, closing);
  std::optional<Nanoseconds> first;
  std::optional<bool> touched;
  play(frames, simulation, [&](const Simulation& now) {
    const FrameResult& result = now.result();
    if (!first) first = result.stamp;
    if (!touched && to_seconds(result.stamp - *first) >= time)
      touched = std::any_of(result.contacts.begin(), result.contacts.end(),
                            [](const Contact& contact) { return contact.touching(); });
  });
  return touched.value_or(true);
}

struct Tally {
  int said = 0, so = 0;
  std::string not_so;
};

/// A closing hand, and the frames around it.
struct Case {
  Closing closing;
  std::vector<JointsFrame> frames;
  std::string recording;
};

std::vector<Case> cases_of(const Row& row) {
  std::vector<Case> cases;
  for (const std::string& file : recording_files({testing::recordings_folder()})) {
    const Recording recording = load_recording(file);
    for (const Closing& closing : closings(recording, row))
      cases.push_back(
          {closing, disturbed(recording.frames, closing.begin, closing.last, {}), recording.name});
  }
  return cases;
}

std::vector<YAML::Node> losses_of(const std::vector<Case>& cases, const Setting& setting) {
  Runs runs;
  for (const Case& one : cases) runs.add(one.frames, one.closing, setting);
  return runs.losses();
}

/// For each first loss attributed to an opening hand: whether the body stays if the fingers do not open.
void keep_fingers_closed(const Setting& setting, Tally& tally) {
  const std::vector<Case> cases = cases_of(setting.row);
  const std::vector<YAML::Node> losses = losses_of(cases, setting);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Case& one = cases[i];
    if (losses[i].size() == 0 || losses[i][0]["cause"].as<std::string>() != "hand_opened") continue;
    const YAML::Node loss = losses[i][0];
    ++tally.said;
    const auto kept =
        with_fingers_kept(one.frames, one.closing.hand, loss["opened"].as<double>() - kFilterLag);
    const bool so = touched_at(loss["until"].as<double>() + kLonger, kept, one.closing, setting);
    tally.so += so;
    if (!so) tally.not_so += one.recording + ": " + loss["text"].as<std::string>() + "\n";
  }
}

// Over more than 20 cubes and 17 spheres. In the exceptions fingers went through the body, and it was out
// before they opened.
TEST(ExplainedGrasps, WhatIsLetGoByAHandThatOpensStaysInOneThatDoesNot) {
  MRHI_NEED_RECORDINGS(testing::recordings());
  for (const Setting& setting : {Setting{{"cube", Kind::pinch, false, 0.04, 0.1}, 0.8, true},
                                 Setting{{"sphere", Kind::grab, true, 0.06, 0.1}, 0.8, true}}) {
    Tally tally;
    keep_fingers_closed(setting, tally);
    RecordProperty(setting.row.name + "_so", std::to_string(tally.so) + " of " + std::to_string(tally.said));
    EXPECT_GT(tally.said, 15) << setting.row.name;
    EXPECT_GE(tally.so, 0.9 * tally.said) << setting.row.name << '\n' << tally.not_so;
  }
}

bool slid(const YAML::Node& loss) {
  const auto cause = loss["cause"].as<std::string>();
  return cause == "too_little_friction" || cause == "too_little_force";
}

/// Losses of a setting; for those by sliding, whether the body stays at 1.2 times the reported friction.
void try_friction(const Setting& setting, int& count, Tally& tally) {
  const std::vector<Case> cases = cases_of(setting.row);
  const std::vector<YAML::Node> losses = losses_of(cases, setting);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    for (const YAML::Node& loss : losses[i]) {
      ++count;
      const auto text = loss["text"].as<std::string>();
      EXPECT_EQ(text.find("inf"), std::string::npos) << text;
      EXPECT_EQ(text.find("nan"), std::string::npos) << text;
      EXPECT_NE(text.find("Last touches: "), std::string::npos) << text;
      if (!slid(loss)) continue;
      ++tally.said;
      Setting other = setting;
      other.friction = 1.2 * std::max(setting.friction, loss["friction_needed"].as<double>());
      tally.so += touched_at(loss["until"].as<double>() + kLonger, cases[i].frames, cases[i].closing, other);
    }
  }
}

// The reported friction is not asserted: most recorded hands that let a body slide also open.
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
