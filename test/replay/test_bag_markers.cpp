#include <gtest/gtest.h>
#include <mr_hand_interaction/ContactArray.h>
#include <mr_hand_interaction/RenderedView.h>
#include <mr_hand_interaction/SceneDescription.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <std_msgs/UInt32.h>
#include <visualization_msgs/MarkerArray.h>

#include <map>

#include "replay/inputs.h"
#include "replay/replay_files.h"
#include "support/pinch_scene.h"

namespace mrhi {
namespace {

constexpr double kDrawnRate = 60.0;  // of frames [Hz]
constexpr int kDrawnFrames = 60;

/// A cube that is pinched from 0.2 s on, with another friction in the second half if `changed`.
std::string drawn_run(const test::Folder& folder, const std::optional<double>& rate,
                      const std::set<std::size_t>& frames, bool changed = false) {
  const std::string file = folder / "markers.bag";
  const ViewWriter write = marker_bag(file, rate, frames);
  const testing::PinchScene pinch;
  Scene other = pinch.scene();
  other.bodies[0].material.dynamic_friction *= 0.5;
  Simulation first(pinch.scene(), Configuration()), second(other, Configuration());
  for (int i = 0; i < kDrawnFrames; ++i) {
    if (changed && i == kDrawnFrames / 2) second.go_on_from(first);
    Simulation& simulation = changed && i >= kDrawnFrames / 2 ? second : first;
    const double t = i / kDrawnRate;
    simulation.advance({testing::at(t), {pinch.hand(t, Vector3::Zero())}});
    write(simulation);
  }
  return file;
}

struct DrawnBag {
  explicit DrawnBag(const std::string& file) : bag(file), view(bag) {}
  template <typename Message>
  std::vector<Message> all(const std::string& topic) {
    std::vector<Message> messages;
    for (const rosbag::MessageInstance& instance : view) {
      if (instance.getTopic() == topic) messages.push_back(*instance.instantiate<Message>());
    }
    return messages;
  }
  std::vector<ros::Time> times(const std::string& topic) {
    std::vector<ros::Time> found;
    for (const rosbag::MessageInstance& instance : view)
      if (instance.getTopic() == topic) found.push_back(instance.getTime());
    return found;
  }
  bool latched(const std::string& topic) {
    for (const rosbag::ConnectionInfo* connection : view.getConnections())
      if (connection->topic == topic) return connection->header->count("latching") == 1;
    return false;
  }
  rosbag::Bag bag;
  rosbag::View view;
};

std::vector<visualization_msgs::MarkerArray> pictures_of(DrawnBag& bag) {
  return bag.all<visualization_msgs::MarkerArray>("/markers");
}

TEST(MarkerBag, of_chosen_frames_has_their_numbers_and_all_markers_for_good) {
  const test::Folder folder;
  DrawnBag bag(drawn_run(folder, std::nullopt, {0, 30, 59}));
  EXPECT_EQ(bag.view.size(), 6u);
  std::vector<std::uint32_t> numbers;
  for (const std_msgs::UInt32& number : bag.all<std_msgs::UInt32>("/frame")) numbers.push_back(number.data);
  EXPECT_EQ(numbers, (std::vector<std::uint32_t>{0, 30, 59}));
  EXPECT_EQ(bag.times("/frame"), bag.times("/markers"));
  EXPECT_EQ(bag.times("/frame")[1], ros::Time(1.5));
  ASSERT_EQ(pictures_of(bag).size(), 3u);
  for (const visualization_msgs::MarkerArray& picture : pictures_of(bag)) {
    std::set<std::string> drawn;
    for (const visualization_msgs::Marker& marker : picture.markers) {
      drawn.insert(marker.ns);
      EXPECT_EQ(marker.header.frame_id, "world");
      EXPECT_EQ(marker.lifetime, ros::Duration());
    }
    EXPECT_TRUE(drawn.count("objects") == 1 && drawn.count("hand") == 1) << drawn.size();
  }
}

TEST(MarkerBag, of_a_run_has_all_of_each_frame_and_markers_at_their_rate) {
  const test::Folder folder;
  DrawnBag bag(drawn_run(folder, 30.0, {}));
  for (const char* topic : {"/contacts", "/objects", "/rendered_hands", "/tracked_hands", "/rendered_view"})
    EXPECT_EQ(bag.times(topic).size(), std::size_t(kDrawnFrames)) << topic;
  EXPECT_EQ(bag.times("/markers").size(), std::size_t(kDrawnFrames / 2));
  EXPECT_EQ(bag.times("/scene").size(), 1u);
  EXPECT_TRUE(bag.latched("/scene"));
  EXPECT_FALSE(bag.latched("/markers"));
  const auto contacts = bag.all<mr_hand_interaction::ContactArray>("/contacts").back();
  EXPECT_FALSE(contacts.contacts.empty());
  const auto view = bag.all<mr_hand_interaction::RenderedView>("/rendered_view").back();
  EXPECT_EQ(view.contacts, contacts.contacts);
  EXPECT_EQ(view.header.frame_id, "world");
  EXPECT_EQ(view.header.stamp, bag.times("/rendered_view").back());
}

TEST(MarkerBag, of_a_run_whose_scene_changes_has_both_scenes) {
  const test::Folder folder;
  DrawnBag bag(drawn_run(folder, kDrawnRate, {}, true));
  const auto scenes = bag.all<mr_hand_interaction::SceneDescription>("/scene");
  ASSERT_EQ(scenes.size(), 2u);
  EXPECT_EQ(bag.times("/scene")[1], ros::Time(1.5));
  EXPECT_EQ(pictures_of(bag).size(), std::size_t(kDrawnFrames));
}

TEST(MarkerBag, that_cannot_be_written_is_named) {
  const std::string file = "/no such folder/markers.bag";
  const ViewWriter write = marker_bag(file, kDrawnRate, {});
  const testing::PinchScene pinch;
  Simulation simulation(pinch.scene(), Configuration());
  simulation.advance({testing::at(0.0), {}});
  try {
    write(simulation);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find(file), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace mrhi
