#include <gtest/gtest.h>

#include "rendering/skin_paint.h"
#include "support/postures.h"

namespace mrhi {
namespace {

using Touching = std::array<bool, kCapsules>;

std::vector<Rgb> colours_of(const Hand& hand, const Touching& touching) {
  static const SkinPaint paint(Skin::human());
  SkinSurface surface;
  EXPECT_TRUE(Skin::human().pose(hand, surface));
  std::vector<Rgb> colours;
  paint.paint(hand, surface, touching, colours);
  return colours;
}

float brightness(const Rgb& colour) {
  return colour.sum() / 3.0f;
}

TEST(SkinPaint, what_touches_is_highlighted_and_nothing_else) {
  const Hand hand = testing::hand_in(relaxed_posture());
  const auto plain = colours_of(hand, {});
  for (const int touched : {capsule_index(0, 3), capsule_index(1, 3), capsule_index(3, 1), kPalm}) {
    Touching touching{};
    touching[static_cast<std::size_t>(touched)] = true;
    const auto colours = colours_of(hand, touching);
    int highlighted = 0;
    for (std::size_t v = 0; v < colours.size(); ++v) {
      const float share = Skin::human().share(v, touched);
      if (share < 0.3f) {
        EXPECT_TRUE((colours[v] == plain[v]).all());
      } else if (share > 0.8f) {
        EXPECT_LT(colours[v][1] / colours[v][0], 0.6f * plain[v][1] / plain[v][0]);  // redder in any light
        ++highlighted;
      }
    }
    EXPECT_GT(highlighted, 10);
  }
}

TEST(SkinPaint, colours_are_in_range_and_no_side_of_the_hand_is_dark) {
  for (const HandPosture& posture : {relaxed_posture(), testing::fist_posture(), testing::open_posture()}) {
    for (const double turn : {0.0, 0.5, 1.0, 1.5}) {
      const Pose wrist{Vector3::Zero(), Quaternion(Eigen::AngleAxisd(turn * M_PI, Vector3::UnitX()))};
      const Hand hand = complete_hand(hand_joints(human_hand(), Side::right, wrist, posture), Pose{});
      float sum = 0.0f;
      const auto colours = colours_of(hand, {});
      for (const Rgb& colour : colours) {
        EXPECT_TRUE((colour >= 0.0f).all() && (colour <= 1.0f).all());
        sum += brightness(colour);
      }
      EXPECT_GT(sum / static_cast<float>(colours.size()),
                0.4f);  // of 1, sleeve and all
    }
  }
}

TEST(SkinPaint, the_palm_is_darker_under_a_fist) {
  const Touching none{};
  const auto open = colours_of(testing::hand_in(testing::open_posture()), none);
  const auto closed = colours_of(testing::hand_in(testing::fist_posture()), none);
  float lighter = 0.0f;
  for (std::size_t v = 0; v < open.size(); ++v) {
    const Vector3& rest = Skin::human().rest()[v];
    const bool palm = Skin::human().share(v, kPalm) > 0.9f && rest.z() < 0.0;
    if (palm) lighter += brightness(open[v]) - brightness(closed[v]);
  }
  EXPECT_GT(lighter, 1.0f);
}

}  // namespace
}  // namespace mrhi
