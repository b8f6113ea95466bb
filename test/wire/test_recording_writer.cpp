#include "mr_hand_interaction/synthetic/synthetic_hand.h"

#include <gtest/gtest.h>

#include <fstream>

#include "mr_hand_interaction/replay/recording_csv.h"
#include "support/temporary_folder.h"

namespace mrhi {
namespace {

TEST(RecordingWriter, a_frame_without_hands_is_read_back_as_one) {
  std::vector<JointsFrame> written = record_motion({});
  written.resize(3);
  ASSERT_FALSE(written[0].hands.empty() || written[2].hands.empty());
  written[1].hands.clear();
  const test::Folder folder;
  const std::string file = folder / "without_hands.csv";
  {
    std::ofstream out(file);
    write_recording_csv(out, written);
  }
  const auto read = read_recording_csv(file);
  ASSERT_EQ(read.size(), 3u);
  EXPECT_EQ(read[0].hands.size(), 1u);
  EXPECT_TRUE(read[1].hands.empty());
  EXPECT_EQ(read[2].hands.size(), 1u);
}

TEST(RecordingWriter, the_reader_gets_back_what_was_written_to_the_micrometre) {
  SyntheticHandOptions options;
  options.motion = "slap";
  options.side = "left";
  const auto written = record_motion(options);
  const test::Folder folder;
  const std::string file = folder / "slap.csv";
  {
    std::ofstream out(file);
    write_recording_csv(out, written);
  }
  const auto read = read_recording_csv(file);
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_NEAR(to_seconds(read[i].stamp - read[0].stamp), to_seconds(written[i].stamp), 1e-6);
    ASSERT_EQ(read[i].hands.size(), written[i].hands.size()) << i;
    if (read[i].hands.empty()) continue;
    const HandJoints &got = read[i].hands[0], &sent = written[i].hands[0];
    EXPECT_EQ(got.id, sent.id);
    EXPECT_EQ(got.side, sent.side);
    for (std::size_t finger = 0; finger < kFingers; ++finger) {
      EXPECT_NEAR(*got.finger_width[finger], *sent.finger_width[finger], 1e-6);
      for (std::size_t j = 0; j < 5; ++j) {
        // Half a micrometre an axis is cut off by six decimals.
        EXPECT_LT((*got.joints[finger][j] - *sent.joints[finger][j]).norm(), 1e-6);
      }
    }
  }
}

}  // namespace
}  // namespace mrhi
