#include <gtest/gtest.h>

#include <algorithm>

#include "modelling/skin_parts.h"
#include "rendering/skin.h"
#include "support/postures.h"

namespace mrhi {
namespace {

/// A hand that presses something with the pads of these capsules, by `force` [N].
RenderedHand pressing(const Hand& hand, const std::vector<int>& touched, double force) {
  RenderedHand rendered;
  rendered.hand = hand;
  const Vector3 palmar = hand.palm.orientation * -Vector3::UnitZ();
  for (const int c : touched) {
    const auto i = static_cast<std::size_t>(c);
    rendered.touching[i] = true;
    rendered.pressed[i] = {force, hand.capsules[i].centre() + hand.capsules[i].radius * palmar};
  }
  return rendered;
}

std::vector<Rgb> colours_of(const RenderedHand& rendered) {
  SkinSurface surface;
  EXPECT_TRUE(Skin::human().pose(rendered.hand, surface));
  std::vector<Rgb> colours;
  paint_skin(Skin::human(), rendered, surface, colours);
  return colours;
}

float brightness(const Rgb& colour) {
  return colour.sum() / 3.0f;
}

TEST(SkinPaint, what_touches_is_highlighted_and_nothing_else) {
  const Hand hand = testing::hand_in(relaxed_posture());
  const auto plain = colours_of(pressing(hand, {}, 0.0));
  for (const int touched : {capsule_index(0, 3), capsule_index(1, 3), capsule_index(3, 1), kPalm}) {
    const RenderedHand rendered = pressing(hand, {touched}, 10.0);
    const auto colours = colours_of(rendered);
    SkinSurface surface;
    ASSERT_TRUE(Skin::human().pose(hand, surface));
    const auto i = static_cast<std::size_t>(touched);
    const double radius = hand.capsules[i].radius;
    int highlighted = 0;
    for (std::size_t v = 0; v < colours.size(); ++v) {
      const double away = (surface.vertices[v] - rendered.pressed[i].point).norm();
      if (away > 2.0 * radius) {
        EXPECT_TRUE((colours[v] == plain[v]).all());
      } else if (away < 0.6 * radius) {
        EXPECT_LT(colours[v][1] / colours[v][0], 0.6f * plain[v][1] / plain[v][0]);  // redder in any light
      }
      highlighted += (colours[v] != plain[v]).any();
    }
    EXPECT_GT(highlighted, 5) << touched;
  }
}

TEST(SkinPaint, a_firm_press_is_redder_than_a_light_touch) {
  const Hand hand = testing::hand_in(relaxed_posture());
  const int tip = capsule_index(1, 3);
  std::vector<float> greens;
  for (const double force : {0.0, 1.0, 3.0, 6.0}) {
    float green = 0.0f;
    for (const Rgb& colour : colours_of(pressing(hand, {tip}, force))) green += colour[1];
    greens.push_back(green);
  }
  EXPECT_TRUE(std::is_sorted(greens.rbegin(), greens.rend()));
  EXPECT_GT(greens.front(), greens.back() + 1.0f);
}

TEST(SkinPaint, colours_are_in_range_and_no_side_of_the_hand_is_dark) {
  for (const HandPosture& posture : {relaxed_posture(), testing::fist_posture(), testing::open_posture()}) {
    for (const double turn : {0.0, 0.5, 1.0, 1.5}) {
      const Pose wrist{Vector3::Zero(), Quaternion(Eigen::AngleAxisd(turn * M_PI, Vector3::UnitX()))};
      const Hand hand = complete_hand(hand_joints(human_hand(), Side::right, wrist, posture), Pose{});
      float sum = 0.0f;
      const auto colours = colours_of(pressing(hand, {}, 0.0));
      for (const Rgb& colour : colours) {
        EXPECT_TRUE((colour >= 0.0f).all() && (colour <= 1.0f).all());
        sum += brightness(colour);
      }
      EXPECT_GT(sum / static_cast<float>(colours.size()),
                0.4f);  // of 1, sleeve and all
    }
  }
}

// Of few triangles: had they none of their corners in a nail, it would not be seen.
TEST(SkinPaint, every_finger_has_a_nail_on_its_back_lighter_than_the_skin_along_it) {
  const auto colours = colours_of(pressing(testing::hand_in(testing::open_posture()), {}, 0.0));
  const Skin& skin = Skin::human();
  for (int finger = 0; finger < kFingers; ++finger) {
    const int tip = capsule_index(finger, 3);
    const SkinBone& bone = rest_hand().rig[static_cast<std::size_t>(tip)];
    float nail = 0.0f, edge = 0.0f;
    int nails = 0, edges = 0;
    for (std::size_t v = 0; v < skin.size(); ++v) {
      if (capsule_shares(skin.rest()[v])[static_cast<std::size_t>(tip)] < 0.5) continue;
      const SkinNail here = skin_nail(skin.rest()[v]);
      if (here.nail > 0.7) {
        EXPECT_GT((skin.rest()[v] - bone.start).dot(bone.axes.col(2)), 0.0) << finger;
        nail += brightness(colours[v]), ++nails;
      }
      if (here.edge > 0.5) edge += brightness(colours[v]), ++edges;
    }
    ASSERT_GE(nails, 2) << finger;
    ASSERT_GE(edges, 2) << finger;
    EXPECT_GT(nail / static_cast<float>(nails), 1.1f * edge / static_cast<float>(edges)) << finger;
  }
}

TEST(SkinPaint, every_finger_has_creases_at_its_joints_darker_than_the_skin_beside_them) {
  const Skin& skin = Skin::detailed();
  for (int finger = 0; finger < kFingers; ++finger) {
    for (int bone = 2; bone < kBonesPerFinger; ++bone) {
      const SkinBone& rig = rest_hand().rig[static_cast<std::size_t>(capsule_index(finger, bone))];
      float crease = 0.0f, beside = 0.0f;
      int creased = 0, plain = 0;
      for (std::size_t v = 0; v < skin.size(); ++v) {
        const Vector3 place = rig.axes.transpose() * (skin.rest()[v] - rig.start);
        const bool palmar = place.z() < -0.6 * rig.radius && std::abs(place.y()) < 0.5 * rig.radius &&
                            place.norm() < 2.0 * rig.radius;
        if (!palmar) continue;
        const float colour = brightness(skin.model().looks[v].colour);
        if (skin_crease(skin.rest()[v]) > 0.8) crease += colour, ++creased;
        if (skin_crease(skin.rest()[v]) <= 0.0) beside += colour, ++plain;
      }
      ASSERT_GE(creased, 2) << finger << " " << bone;
      ASSERT_GE(plain, 2) << finger << " " << bone;
      EXPECT_LT(crease / static_cast<float>(creased), 0.85f * beside / static_cast<float>(plain)) << finger;
    }
  }
}

TEST(SkinPress, a_pad_that_presses_is_flat_where_it_touches_and_the_flatter_the_harder) {
  const Hand hand = testing::hand_in(testing::open_posture());
  const int tip = capsule_index(1, 3);
  const Capsule& pad = hand.capsules[static_cast<std::size_t>(tip)];
  const Vector3 palmar = hand.palm.orientation * -Vector3::UnitZ();
  SimulationState state;
  state.hands.resize(1);
  Contact contact;
  contact.key.capsule = static_cast<std::uint8_t>(tip);
  contact.normal = -palmar;
  contact.radius = pad.radius;
  contact.depth = 0.001;
  contact.point = pad.centre() + pad.radius * palmar;
  int before = -1;
  for (const double force : {0.0, 1.0, 6.0}) {
    contact.force = force * palmar;
    SkinSurface surface;
    ASSERT_TRUE(Skin::detailed().pose(hand, surface));
    const SkinSurface round = surface;
    flatten_pads({contact}, state, 0, Skin::detailed(), surface);
    int flat = 0;
    for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
      const double height = contact.normal.dot(surface.vertices[v] - contact.point);
      flat += std::abs(height) < 1e-6;
      EXPECT_LE((surface.vertices[v] - round.vertices[v]).norm(), kMaxPadCompression + 1e-9);
      const bool far = (round.vertices[v] - contact.point).norm() > 2.0 * pad.radius;
      EXPECT_TRUE(!far || surface.vertices[v] == round.vertices[v]);
    }
    EXPECT_GT(flat, before + 10 * (force > 0.0)) << force;
    before = flat;
  }
}

TEST(SkinPaint, the_palm_is_darker_under_a_fist) {
  const auto open = colours_of(pressing(testing::hand_in(testing::open_posture()), {}, 0.0));
  const auto closed = colours_of(pressing(testing::hand_in(testing::fist_posture()), {}, 0.0));
  float lighter = 0.0f;
  for (std::size_t v = 0; v < open.size(); ++v) {
    const Vector3& rest = Skin::human().rest()[v];
    const bool palm = capsule_shares(rest)[kPalm] > 0.9f && rest.z() < 0.0;
    if (palm) lighter += brightness(open[v]) - brightness(closed[v]);
  }
  EXPECT_GT(lighter, 1.0f);
}

TEST(Light, comes_from_above_and_leaves_no_side_black_or_blinding) {
  const Rgb up = light_on(Eigen::Vector3f::UnitZ()), down = light_on(-Eigen::Vector3f::UnitZ());
  EXPECT_TRUE((up > down).all());
  for (const Eigen::Vector3f& normal : {Eigen::Vector3f(1, 0, 0), Eigen::Vector3f(-1, 0, 0),
                                        Eigen::Vector3f(0, 1, 0), Eigen::Vector3f(0, -1, 0)}) {
    EXPECT_GT(light_on(normal).minCoeff(), 0.2f);
    EXPECT_LT(light_on(normal).maxCoeff(), 1.2f);
  }
}

TEST(Light, is_less_in_a_fold_where_less_of_it_arrives_from_all_around) {
  const Eigen::Vector3f normal(0.6f, 0.0f, 0.8f);
  EXPECT_TRUE((light_on(normal, 0.5f) < light_on(normal)).all());
  EXPECT_TRUE((light_on(normal, 0.0f) >= 0.0f).all());
}

}  // namespace
}  // namespace mrhi
