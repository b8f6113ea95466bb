#include <gtest/gtest.h>

#include <optional>

#include "mr_hand_interaction/response/contact_model.h"
#include "synthetic/performance.h"
#include "training/operator_trial.h"
#include "training/trials.h"

namespace mrhi {
namespace {

using test::shipped_task;

const Vector3 kObject(0.0, 0.0, 0.22);  // centre of the object in the shipped scenes of one [m]

/// A hand does a task's trial with one of its objects, among what is there in a session; nothing: no hand in
/// view.
template <class HandAt>
TrialResult result_of(const Task& task, std::size_t object, double duration, HandAt hand_at) {
  constexpr double kRate = 115.0;
  OperatorStage stage;
  stage.scene_folders = {"config/scenes"};
  stage.scene_options.default_material = default_material(stage.configuration);
  Scene scene = operator_scene(task, task.objects.at(object), stage);
  if (scene.joints.empty()) scene.bounds = load_scene("config/scenes/cube.urdf", stage.scene_options).bounds;
  const auto body = static_cast<std::size_t>(*find_body(scene, task.objects.at(object).name));
  stage.configuration.gravity = task.gravity;
  Simulation simulation(scene, stage.configuration);
  Trial trial(task);
  for (int i = 0; i < duration * kRate && trial.result() == TrialResult::none; ++i) {
    HandFrame frame{static_cast<Nanoseconds>(1e9 * i / kRate), {}};
    if (const std::optional<HandPlace> hand = hand_at(to_seconds(frame.stamp)))
      frame.hands.push_back(
          complete_hand(hand_joints(human_hand(), Side::right, hand->wrist, hand->posture), Pose{}));
    EXPECT_EQ(Rejection::none, simulation.advance(frame));
    trial.update(observe(simulation, body));
  }
  return trial.result();
}

TrialResult result_of(const Task& task, std::size_t object, const std::vector<Keyframe>& way) {
  const double end = way.back().time, drift_time = 3.0;
  return result_of(task, object, end + drift_time, [&](double time) {
    return time > end ? std::nullopt : std::optional<HandPlace>(hand_at(way, time));
  });
}

std::vector<Keyframe> shifted(std::vector<Keyframe> way, const Vector3& by, double later) {
  for (Keyframe& key : way) {
    key.wrist.position += by;
    key.time += later;
  }
  return way;
}

// The remaining task, pick_and_place, is what the simulated operators do: OperatorTakes.
TEST(TaskToTheEnd, tap) {
  const Task task = shipped_task("tap");
  const std::vector<Keyframe> tap = make_motion("tap").keyframes;
  constexpr double kHigher = 0.1 - 0.025;  // of the long cuboid's end above the cube's upper face
  EXPECT_EQ(TrialResult::completed, result_of(task, 0, tap));
  EXPECT_EQ(TrialResult::completed, result_of(task, 1, shifted(tap, {0.0, 0.0, kHigher}, 0.0)));
  EXPECT_EQ(TrialResult::none, result_of(task, 0, make_motion("slap").keyframes));
}

TEST(TaskToTheEnd, slap) {
  const Task task = shipped_task("slap");
  const std::vector<Keyframe> slap = make_motion("slap").keyframes;
  EXPECT_EQ(TrialResult::completed, result_of(task, 0, slap));
  EXPECT_EQ(TrialResult::completed, result_of(task, 1, slap));
  EXPECT_EQ(TrialResult::none, result_of(task, 0, make_motion("tap").keyframes));
}

TEST(TaskToTheEnd, catch_ball) {
  const Task task = shipped_task("catch");
  const TaskObject& ball = task.objects.at(0);
  const double later = ball.start.position.y() / -ball.twist.linear.y();  // the script's ball starts nearer
  EXPECT_EQ(TrialResult::completed,
            result_of(task, 0, shifted(make_motion("catch_ball").keyframes, Vector3::Zero(), later)));
}

/// A finger pushes the cube on its way, and the palm waits for it in the box.
std::vector<Keyframe> nudge_and_stop(const Goal& goal, const Vector3& start) {
  const std::vector<Keyframe> nudge = make_motion("nudge").keyframes, slap = make_motion("slap").keyframes;
  std::vector<Keyframe> way{nudge.front()};
  const auto then = [&](double duration, const Pose& wrist, const Vector3& by, const HandPosture& posture) {
    way.push_back({way.back().time + duration, {wrist.position + by, wrist.orientation}, posture});
  };
  const Pose about{start, turn(-90.0, Vector3::UnitZ())};  // the script pushes along y
  const auto turned = [&](const Pose& wrist) {
    return about * Pose{wrist.position - kObject, wrist.orientation};
  };
  const Pose ready = turned(nudge[1].wrist), pushed = turned(nudge[3].wrist);
  way.front().wrist = turned(nudge.front().wrist);
  // Half way from drawn to through, the palm meets the cube.
  Pose stop = slap[1].wrist;
  stop.position = 0.5 * (slap[1].wrist.position + slap[3].wrist.position) + goal.position - kObject;
  const Vector3 up(0.0, 0.0, 0.2), aside(0.05, 0.0, 0.2), ahead(0.02, 0.0, 0.0);
  then(1.0, ready, Vector3::Zero(), pointing_posture());
  then(6.0, pushed, Vector3::Zero(), pointing_posture());
  then(0.3, ready, Vector3::Zero(), pointing_posture());
  then(0.4, ready, up, flat_posture());
  then(0.5, stop, aside, flat_posture());
  then(0.4, stop, ahead, flat_posture());
  then(3.0, stop, ahead, flat_posture());
  return way;
}

TEST(TaskToTheEnd, nudge_into_box) {
  const Task task = shipped_task("nudge_into_box");
  const Vector3& start = task.objects.at(0).start.position;
  EXPECT_EQ(TrialResult::completed, result_of(task, 0, nudge_and_stop(task.goals.at(0), start)));
}

/// Presses the button that is there, opens the hatch, and closes it the way it was opened; nothing: out of
/// view.
struct WorksTheHatch {
  static constexpr double kAway = 1.0, kByTheHandle = 8.8;  // [s]; the last part of open_hatch
  std::vector<Keyframe> press = make_motion("press_button").keyframes,
                        open = make_motion("open_hatch").keyframes;
  double opens = press.back().time + kAway, closes = opens + open.back().time + kAway;
  double pause = 0.0;  // before it closes [s]

  std::optional<HandPlace> operator()(double time) const {
    if (time <= press.back().time) {
      HandPlace hand = hand_at(press, time);
      hand.wrist.position.z() += 0.17 - 0.36;  // from the panel's button to the third one here
      return hand;
    }
    if (time >= opens && time <= opens + open.back().time) return hand_at(open, time - opens);
    const double back = time - closes - pause;
    if (back < 0.0 || back > kByTheHandle) return std::nullopt;
    return hand_at(open, open.back().time - back);
  }
};

TEST(TaskToTheEnd, hatch) {
  Task task = shipped_task("hatch");
  const WorksTheHatch hand;
  EXPECT_EQ(TrialResult::completed, result_of(task, 0, 45.0, hand));
  EXPECT_EQ(TrialResult::none, result_of(task, 0, hand.closes, hand)) << "not yet closed";
  task.goals[3].within = 2.0;
  EXPECT_EQ(TrialResult::timed_out, result_of(task, 0, 45.0, hand)) << "it takes longer to the handle";
}

}  // namespace
}  // namespace mrhi
