#include "replay/demonstration.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "mr_hand_interaction/scene/scene_loader.h"
#include "mr_hand_interaction/synthetic/scripted_motion.h"
#include "replay/frame_source.h"
#include "replay/replay_files.h"
#include "text/text.h"

namespace mrhi {
namespace {

constexpr double kRate = 90.0;

/// The cube is taken, carried and let go.
Demonstration carried() {
  Simulation simulation(load_scene("config/scenes/cube.urdf", {}), Configuration());
  Demonstration demonstration;
  for (const JointsFrame& joints : test::motion_frames("grasp_cube", kRate, 1'000'000'000)) {
    simulation.advance(*placed(joints, default_device_mount()).frame);
    demonstration.watch(simulation);
  }
  return demonstration;
}

TEST(Demonstration, events_and_the_way_stay_the_same_at_another_rate) {
  const Demonstration own = carried(), even = own.at_rate(100.0);
  std::vector<std::string> events, even_events;
  for (const auto& frame : own.frames())
    events.insert(events.end(), frame.events.begin(), frame.events.end());
  for (const auto& frame : even.frames())
    even_events.insert(even_events.end(), frame.events.begin(), frame.events.end());
  EXPECT_NE(std::find(events.begin(), events.end(), "GRASP_BEGIN cube"), events.end());
  EXPECT_EQ(std::vector<std::string>(events.begin(), events.begin() + static_cast<long>(even_events.size())),
            even_events);
  for (std::size_t i = 1; i < even.frames().size(); ++i)
    EXPECT_EQ(even.frames()[i].stamp - even.frames()[i - 1].stamp, 10'000'000);
  // Of a hand that is no faster than 1 m/s a line is off by what it is accelerated by in half a frame:
  // micrometres.
  const auto near = [&](Nanoseconds stamp) {
    return *std::min_element(own.frames().begin(), own.frames().end(), [&](const auto& a, const auto& b) {
      return std::abs(a.stamp - stamp) < std::abs(b.stamp - stamp);
    });
  };
  for (const auto& frame : even.frames()) {
    const auto closest = near(frame.stamp);
    const Vector3 apart = frame.objects.at("cube").pose.position - closest.objects.at("cube").pose.position;
    EXPECT_LE(apart.norm(), 1.0 * to_seconds(std::abs(frame.stamp - closest.stamp)) + 1e-6);
  }
}

TEST(Demonstration, the_table_has_a_cell_for_each_column_and_what_carries_the_cube) {
  const test::TemporaryFolder folder;
  write_demonstration_csv(carried(), folder / "demonstration.csv");
  const auto lines = test::lines_of(folder / "demonstration.csv");
  const auto names = text::split(lines.front());
  const auto column = [&](const std::string& name) {
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  };
  ASSERT_LT(column("cube.held"), names.size());
  ASSERT_LT(column("right.index_3.x"), names.size());
  EXPECT_EQ(column("left.palm.px"), names.size()) << "there is no left hand";
  bool held = false;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const auto cells = text::split(lines[i]);
    ASSERT_EQ(cells.size(), names.size());
    held |= cells[column("cube.held")] == "1";
  }
  EXPECT_TRUE(held);
}

TEST(Demonstration, joints_are_bent_by_the_angle_between_their_bones) {
  Hand hand;
  const auto bone = [&](int index, const Vector3& from, const Vector3& to) {
    hand.capsules[static_cast<std::size_t>(capsule_index(1, index))] = {from, to, 0.008};
  };
  bone(0, {0, 0, 0}, {0.06, 0, 0});
  bone(1, {0.06, 0, 0}, {0.1, 0, 0});
  bone(2, {0.1, 0, 0}, {0.1, 0, -0.03});
  const auto angles = joint_angles(hand);
  ASSERT_EQ(angles.size(), 2u);
  EXPECT_EQ(angles[0].first, "index_1");
  EXPECT_NEAR(angles[0].second, 0.0, 1e-12);
  EXPECT_EQ(angles[1].first, "index_2");
  EXPECT_NEAR(angles[1].second, 0.5 * M_PI, 1e-12);
}

}  // namespace
}  // namespace mrhi
