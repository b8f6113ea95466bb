#include <gtest/gtest.h>

#include <map>

#include "simulation/simulation_impl.h"
#include "support/fixtures.h"
#include "synthetic/performance.h"
#include "training/operator_trial.h"

namespace mrhi {
namespace {

/// The level after an event, or nothing if the event may not come at this level.
std::optional<InteractionLevel> after(EventKind kind, InteractionLevel level) {
  struct Step {
    EventKind kind;
    InteractionLevel from, to;
  };
  constexpr Step kSteps[] = {
      {EventKind::hover_begin, InteractionLevel::none, InteractionLevel::hover},
      {EventKind::contact_begin, InteractionLevel::hover, InteractionLevel::contact},
      {EventKind::grasp_begin, InteractionLevel::contact, InteractionLevel::grasp},
      {EventKind::grasp_end, InteractionLevel::grasp, InteractionLevel::contact},
      {EventKind::contact_end, InteractionLevel::contact, InteractionLevel::hover},
      {EventKind::hover_end, InteractionLevel::hover, InteractionLevel::none},
  };
  for (const Step& step : kSteps)
    if (step.kind == kind && step.from == level) return step.to;
  return std::nullopt;
}

/// Follows the levels of all bodies as the events tell them.
class Levels {
 public:
  void see(const std::vector<Event>& events) {
    for (const Event& event : events) {
      if (event.kind == EventKind::hand_lost) expect_all_ended();
      if (event.body < 0 || event.kind >= EventKind::out_of_bounds) continue;  // nor of its joint
      InteractionLevel& level = levels_[event.body];
      const auto next = after(event.kind, level);
      EXPECT_TRUE(next.has_value()) << static_cast<int>(event.kind) << " at " << static_cast<int>(level);
      level = next.value_or(level);
      ++count[event.kind];
    }
  }
  void expect_all_ended() const {
    for (const auto& [body, level] : levels_) EXPECT_EQ(level, InteractionLevel::none) << body;
  }
  std::map<EventKind, int> count;

 private:
  std::map<int, InteractionLevel> levels_;
};

TEST(Events, of_every_motion_come_in_their_fixed_order_and_end_with_the_hand) {
  for (const std::string& name : motion_names()) {
    SyntheticHandOptions options;
    options.motion = name;
    SyntheticHand source(options);
    Simulation simulation(testing::staged_scene(source.motion(), Configuration(), stand_under),
                          Configuration());
    Levels levels;
    Nanoseconds stamp = 0;
    while (source.next_run() == 0) {
      const JointsFrame joints = source.next();
      HandFrame frame{stamp = joints.stamp, {}};
      for (const HandJoints& hand : joints.hands)
        frame.hands.push_back(complete_hand(hand, default_device_mount()));
      simulation.advance(frame);
      levels.see(simulation.result().events);
    }
    simulation.advance_without_hands(stamp + 1'000'000'000);
    levels.see(simulation.result().events);
    levels.expect_all_ended();
    EXPECT_GT(levels.count[EventKind::contact_begin], 0) << name;
    EXPECT_EQ(levels.count[EventKind::hover_begin], levels.count[EventKind::hover_end]) << name;
    EXPECT_EQ(levels.count[EventKind::grasp_begin], levels.count[EventKind::grasp_end]) << name;
  }
}

TEST(Events, hovering_begins_at_30_mm_and_ends_at_45) {
  Body cube = testing::box_body(Vector3::Constant(0.05), 0.1);
  Simulation simulation(testing::scene_of(cube), testing::unfiltered());
  constexpr double kRadius = 0.008;
  int frame = 0;
  const auto hovers_at = [&](double gap) {
    const Vector3 start(0.025 + kRadius + gap, 0.0, 0.0);
    simulation.advance(
        {testing::at(0.01 * frame++), {testing::finger(start, start + Vector3(0.02, 0, 0), kRadius)}});
    return simulation.state().interactions.at(0).level == InteractionLevel::hover;
  };
  EXPECT_FALSE(hovers_at(0.050));
  EXPECT_FALSE(hovers_at(0.031));
  EXPECT_TRUE(hovers_at(0.029));
  EXPECT_TRUE(hovers_at(0.044));
  EXPECT_FALSE(hovers_at(0.046));
  EXPECT_FALSE(hovers_at(0.031));
}

/// Two fingertips of one hand that press a body by `first` and `second`, `angle` [rad] between the pushes.
std::vector<Contact> pressing(double first, double second, double angle) {
  std::vector<Contact> contacts(2);
  contacts[0].key.capsule = static_cast<std::uint8_t>(capsule_index(0, 3));
  contacts[1].key.capsule = static_cast<std::uint8_t>(capsule_index(1, 3));
  contacts[0].depth = first;
  contacts[1].depth = second;
  contacts[0].normal = Vector3::UnitX();
  contacts[1].normal = Vector3(std::cos(angle), std::sin(angle), 0.0);
  return contacts;
}

TEST(Events, a_grasp_may_become_less_balanced_than_it_began) {
  const Scene scene = testing::scene_of(testing::box_body(Vector3::Constant(0.05), 0.1));
  const SceneGeometry geometry(scene);
  const ContactFinder finder(scene, geometry, Vector3::Zero());
  const auto seen = [&](double angle, InteractionLevel before) {
    return seen_level(Hand(), 0, 0, finder, scene, Pose(), pressing(0.001, 0.001, angle), before);
  };
  // What is left of two equal pushes is the cosine of half the angle between them.
  const double balanced = 2.0 * std::acos(0.55), slack = 2.0 * std::acos(0.7),
               one_sided = 2.0 * std::acos(0.8);
  EXPECT_EQ(seen(balanced, InteractionLevel::contact), InteractionLevel::grasp);
  EXPECT_EQ(seen(slack, InteractionLevel::contact), InteractionLevel::contact);
  EXPECT_EQ(seen(slack, InteractionLevel::grasp), InteractionLevel::grasp);
  EXPECT_EQ(seen(one_sided, InteractionLevel::grasp), InteractionLevel::contact);
}

}  // namespace
}  // namespace mrhi
