// Tasks of an operator who floats, done to the end by scripted hands of a person's strength.

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "mr_hand_interaction/response/contact_model.h"
#include "support/pinch_scene.h"
#include "training/operator_trial.h"
#include "training/trials.h"

namespace mrhi {
namespace {

using namespace testing;
using test::shipped_task;

constexpr double kTip = 0.008;

/// A grip around a point: the thumb at -y, four fingers at +y, along z; all `off` from the point.
Hand grip(std::uint32_t id, const Vector3& point, double off) {
  Hand hand;
  hand.id = id;
  hand.side = id == 1 ? Side::left : Side::right;
  hand.palm.position = point + Vector3(0, 0, -0.08);
  for (int finger = 0; finger < kFingers; ++finger) {
    const Vector3 tip =
        point + Vector3(finger == 0 ? 0.0 : 0.014 * (finger - 2.5), finger == 0 ? -off : off, 0.0);
    add_finger(hand, capsule_index(finger, 3), tip - Vector3(0, 0, 0.01), tip + Vector3(0, 0, 0.01), kTip);
  }
  return hand;
}

/// From 15 mm off a body of this half width to 3 mm into it.
double around(double half, double closed) {
  return half + kTip + 0.015 - 0.018 * closed;
}

const Vector3 kRail(0.0, 0.15, 0.25);
constexpr double kHalfRail = 0.016;

class FloatingTask {
 public:
  explicit FloatingTask(const std::string& name) : task_(shipped_task(name)) {
    OperatorStage stage;
    stage.scene_folders = {"config/scenes"};
    stage.scene_options.default_material = default_material(stage.configuration);
    stage.configuration.filter.type = FilterKind::none;
    stage.configuration.gravity = task_.gravity;
    simulation_.emplace(operator_scene(task_, task_.objects.front(), stage), stage.configuration);
    trial_.emplace(task_);
  }
  const Trial& trial() const { return *trial_; }
  bool running() const { return trial_->result() == TrialResult::none; }
  const Pose& person() const {
    return simulation_->state().bodies[static_cast<std::size_t>(simulation_->scene().operators[0].body)].pose;
  }
  /// The frame in which the hands are tracked.
  Pose frame() const {
    const Scene& scene = simulation_->scene();
    return person() * scene.bodies[static_cast<std::size_t>(scene.operators[0].body)].link_in_body;
  }
  template <class HandsAt>
  void run(double seconds, HandsAt hands_at) {
    for (int i = 0; i < 120.0 * seconds && running(); ++i, ++frame_) {
      const double t = i / 120.0;
      EXPECT_EQ(simulation_->advance({at(frame_ / 120.0), hands_at(t)}), Rejection::none);
      trial_->update(observe(*simulation_, 0));
    }
  }

 private:
  Task task_;
  std::optional<Simulation> simulation_;
  std::optional<Trial> trial_;
  int frame_ = 0;
};

constexpr double kGlide = 0.15;  // [m/s]; people go 0.1 to 0.3 m/s along a rail

/// Both hands pull until the operator glides, and release the rail. Later they hold it again, and `stop`.
void go_along_the_rail(FloatingTask& task, bool stop) {
  const Vector3 left = kRail - Vector3(0.1, 0, 0), right = kRail + Vector3(0.3, 0, 0);
  const auto both = [](const Vector3& one, const Vector3& other, double closed) {
    return std::vector<Hand>{grip(1, one, around(kHalfRail, closed)),
                             grip(2, other, around(kHalfRail, closed))};
  };
  task.run(3.6, [&](double t) {
    const double x = std::clamp((t - 0.5) / 2.0, 0.0, 1.0);
    const Vector3 pulled(kGlide * (2.0 * x * x * x * (1.0 - 0.5 * x) + std::max(0.0, t - 2.5)), 0, 0);
    return both(left - pulled, right - pulled, smooth(t, 0.4) - smooth(t - 3.2, 0.3));
  });
  const auto no_hands = [](double) { return std::vector<Hand>{}; };
  while (task.running() && task.person().position.x() < 0.65) task.run(1.0 / 120.0, no_hands);
  if (!stop) return task.run(5.0, no_hands);
  // Hands wait at the rail, where it is seen, until they are closed.
  const Vector3 along(task.person().position.x(), 0, 0);
  Vector3 one, other;
  task.run(0.5, [&](double t) {
    one = task.frame().inverse() * Vector3(left + along);
    other = task.frame().inverse() * Vector3(right + along);
    return both(one, other, smooth(t, 0.4));
  });
  task.run(8.0, [&](double t) {
    const double x = std::min(t / 2.0, 1.0);
    const Vector3 pushed(2.0 * kGlide * x * (1.0 - 0.5 * x), 0, 0);
    return both(one - pushed, other - pushed, 1.0);
  });
}

TEST(FloatingTask, rail_is_done_by_who_pulls_along_it_and_stops_at_the_mark) {
  FloatingTask task("rail");
  go_along_the_rail(task, true);
  const TrialMeasures& measures = task.trial().measures();
  EXPECT_EQ(task.trial().result(), TrialResult::completed) << task.person().position.transpose();
  EXPECT_GE(measures.touches, 4);  // each hand took the rail twice
  EXPECT_GT(measures.completion_time, 6.0);
  ASSERT_TRUE(measures.arrival_speed && measures.misplacement && measures.operator_speed);
  EXPECT_LT(*measures.operator_speed, 0.03);
  EXPECT_LE(*measures.misplacement, 0.15);
  EXPECT_LT(*measures.arrival_speed, kGlide + 0.02);
}

TEST(FloatingTask, rail_is_not_done_by_who_glides_past_the_mark) {
  FloatingTask task("rail");
  go_along_the_rail(task, false);
  EXPECT_EQ(task.trial().result(), TrialResult::none);
  ASSERT_TRUE(task.trial().measures().arrival_speed);
  EXPECT_NEAR(*task.trial().measures().arrival_speed, kGlide, 0.03);
  EXPECT_NEAR(*task.trial().measures().operator_speed, kGlide, 0.03);
}

/// The right hand throws the bag at 1 m/s; the left hand holds the rail, or not.
void throw_the_bag(FloatingTask& task, bool with_a_hand_on_the_rail) {
  constexpr double kSpeed = 1.0, kBegin = 0.6, kAccelerates = 0.5, kOpens = kBegin + kAccelerates;
  task.run(8.0, [&](double t) {
    std::vector<Hand> hands;
    if (with_a_hand_on_the_rail)
      hands.push_back(grip(1, kRail + Vector3(-0.5, 0, 0), around(kHalfRail, smooth(t, 0.4))));
    const double x = std::clamp((t - kBegin) / kAccelerates, 0.0, 1.0);
    const double moved = kSpeed * (kAccelerates * x * x * x * (1.0 - 0.5 * x) + std::max(0.0, t - kOpens));
    const double off = around(0.03, smooth(t, 0.4)) + 0.5 * std::max(0.0, t - kOpens - 0.02);
    if (t < kOpens + 0.1) hands.push_back(grip(2, Vector3(0.1 - moved, -0.05, 0.25), off));
    return hands;
  });
}

TEST(FloatingTask, throw_is_done_by_who_holds_a_rail) {
  FloatingTask task("throw");
  throw_the_bag(task, true);
  const TrialMeasures& measures = task.trial().measures();
  EXPECT_EQ(task.trial().result(), TrialResult::completed) << "goal " << task.trial().goal() + 1;
  ASSERT_TRUE(measures.operator_spin && measures.arrival_speed);
  EXPECT_LT(*measures.operator_spin, 0.05);
  EXPECT_NEAR(*measures.arrival_speed, 1.0, 0.1) << "of the bag that flies into the net";
}

/// 1 kg at 1 m/s leaves at 0.35 m from the centre of mass of a person whose moment is 80 kg (0.14 m)^2:
/// some 0.2 rad/s, until the hand has turned the direction.
TEST(FloatingTask, throw_leaves_who_holds_nothing_spinning) {
  FloatingTask task("throw");
  throw_the_bag(task, false);
  const TrialMeasures& measures = task.trial().measures();
  EXPECT_EQ(task.trial().result(), TrialResult::none);
  EXPECT_EQ(task.trial().goal(), 2u) << "the bag is in the net";
  ASSERT_TRUE(measures.operator_spin && measures.operator_speed);
  EXPECT_GT(*measures.operator_spin, 0.1);
  EXPECT_NEAR(*measures.operator_speed, 1.0 / 80.0, 0.003);
}

TEST(FloatingTask, dock_and_hatch_have_their_operator_and_what_their_goals_name) {
  for (const char* const name : {"dock", "hatch_0g"}) {
    FloatingTask task(name);
    task.run(0.1, [](double) { return std::vector<Hand>{}; });
    EXPECT_EQ(task.trial().goal(), 0u);
    EXPECT_TRUE(task.trial().measures().operator_speed) << name;
  }
}

}  // namespace
}  // namespace mrhi
