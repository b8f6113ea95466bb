#include <gtest/gtest.h>

#include "mr_hand_interaction/replay/recording_csv.h"
#include "mr_hand_interaction/synthetic/scripted_motion.h"
#include "rendering/skin_checks.h"
#include "support/recordings.h"

namespace mrhi {
namespace {

// A tracker's wrist may be far from the metacarpals, and fingers may bend as none can: then a few of the
// triangles fold in the bend.
TEST(SkinOfRecordings, stays_on_the_bones_of_every_recorded_hand) {
  const auto files = testing::recordings();
  MRHI_NEED_RECORDINGS(files)
  constexpr std::size_t kEvery = 30;  // frames
  SkinSurface surface;
  std::vector<std::string> ignored;
  for (const std::string& file : files) {
    const auto frames = read_recording_csv(file);
    for (std::size_t f = 0; f < frames.size(); f += kEvery) {
      const auto frame = complete_frame(frames[f], default_device_mount(), ignored);
      if (!frame) continue;
      for (const Hand& hand : frame->hands) {
        if (!Skin::human().pose(hand, surface)) continue;
        ASSERT_TRUE(testing::finite(surface)) << file << ", frame " << f;
        ASSERT_LT(testing::farthest_from_bones(hand, surface), 0.5) << file << ", frame " << f;
        ASSERT_LT(testing::flipped_triangles(hand.side, surface), 25) << file << ", frame " << f;
      }
    }
  }
}

}  // namespace
}  // namespace mrhi
