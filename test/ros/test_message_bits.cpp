#include <rosbag/bag.h>
#include <rosbag/view.h>

#include "math/fnv1a.h"
#include "mr_hand_interaction/replay/replay.h"
#include "mr_hand_interaction/synthetic/synthetic_hand.h"
#include "replay/replay_files.h"
#include "support/reviewed_bits.h"

namespace mrhi {
namespace {

/// Adds the topic and the bytes of a message.
void add(const rosbag::MessageInstance& message, Fnv1a& hash) {
  std::vector<std::uint8_t> bytes(message.size());
  ros::serialization::OStream stream(bytes.data(), message.size());
  message.write(stream);
  hash.add(message.getTopic().data(), message.getTopic().size());
  hash.add(bytes.data(), bytes.size());
}

/// Bits of the markers of a scripted motion with a Leap's noise, and of all other messages that a node
/// publishes.
std::string bits_of_messages(const std::string& motion, double gravity) {
  const test::Folder folder;
  std::vector<JointsFrame> frames = test::motion_frames(motion, 60.0, 0);
  TrackingNoise noise(1.0, 1);
  for (JointsFrame& frame : frames) noise.apply(frame);
  ReplayArguments arguments;
  arguments.scene = std::string("config/scenes/") + make_motion(motion).scene + ".urdf";
  arguments.input = test::write_recording(folder / "recording.csv", frames);
  arguments.output = folder / "out";
  arguments.settings = {{"gravity", "[0, 0, " + std::to_string(gravity) + "]"}};
  arguments.marker_rate = 30.0;
  replay(arguments);
  Fnv1a markers, others;
  rosbag::Bag bag(folder / "out/markers.bag");
  for (const rosbag::MessageInstance& message : rosbag::View(bag))
    add(message, message.getTopic() == "/markers" ? markers : others);
  return test::hexadecimal(markers.value) + "," + test::hexadecimal(others.value);
}

TEST(MessageBits, are_those_that_were_reviewed) {
  test::ReviewedBits bits("test/ros/bits.csv", "motion,gravity,markers,others");
  if (!bits.made_elsewhere().empty()) GTEST_SKIP() << bits.made_elsewhere();
  for (const std::string& motion : motion_names()) {
    bits.compare(motion + ",0", bits_of_messages(motion, 0.0));
    if (motion == "grasp_cube" || motion == "lift_flat")
      bits.compare(motion + ",-9.81", bits_of_messages(motion, -9.81));
  }
  bits.check("ros");
}

}  // namespace
}  // namespace mrhi
