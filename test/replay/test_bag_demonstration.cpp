#include <geometry_msgs/PoseStamped.h>
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <set>

#include "mr_hand_interaction/replay/replay.h"
#include "replay/replay_files.h"

namespace mrhi {
namespace {

TEST(BagDemonstration, has_standard_messages_alone_and_a_pose_for_each_row) {
  const test::TemporaryFolder folder;
  ReplayArguments arguments;
  arguments.scene = "config/scenes/cube.urdf";
  arguments.input =
      test::write_recording(folder / "nudge.csv", test::motion_frames("nudge", 90.0, 1'000'000'000));
  arguments.output = folder / "out";
  arguments.demonstration = 100.0;
  replay(arguments);
  const std::size_t rows = test::lines_of(folder / "out/demonstration.csv").size() - 1;
  const rosbag::Bag bag(folder / "out/demonstration.bag");
  std::set<std::string> types;
  for (const rosbag::ConnectionInfo* connection : rosbag::View(bag).getConnections())
    types.insert(connection->datatype);
  EXPECT_EQ(types,
            (std::set<std::string>{"geometry_msgs/PoseStamped", "geometry_msgs/WrenchStamped",
                                   "sensor_msgs/JointState", "std_msgs/String", "tf2_msgs/TFMessage"}));
  rosbag::View poses(bag, rosbag::TopicQuery("/demonstration/cube/pose"));
  EXPECT_EQ(poses.size(), rows);
}

}  // namespace
}  // namespace mrhi
