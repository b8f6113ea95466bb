#include <gtest/gtest.h>

#include <map>
#include <tuple>

#include "modelling/skin_model.h"
#include "modelling/skin_parts.h"
#include "modelling/skin_shape.h"
#include "mr_hand_interaction/synthetic/synthetic_hand.h"
#include "rendering/skin.h"
#include "rendering/skin_checks.h"
#include "support/postures.h"
#include "tracking/adult_hand.h"

namespace mrhi {
namespace {

using testing::farthest_from_bones;
using testing::finite;
using testing::fist_posture;
using testing::flipped_triangles;
using testing::hand_in;
using testing::open_posture;

SkinSurface skin_of(const Hand& hand) {
  SkinSurface surface;
  EXPECT_TRUE(Skin::human().pose(hand, surface));
  return surface;
}

HandJoints scaled(HandJoints hand, double factor) {
  for (auto& finger : hand.joints)
    for (auto& joint : finger) *joint *= factor;
  *hand.palm_centre *= factor;
  *hand.wrist *= factor;
  *hand.palm_width *= static_cast<float>(factor);
  for (auto& width : hand.finger_width) *width *= static_cast<float>(factor);
  return hand;
}

void expect_closed(const Skin& skin) {
  std::map<std::pair<int, int>, int> edges;
  for (const auto& triangle : skin.triangles()) {
    for (std::size_t i = 0; i < 3; ++i) ++edges[{triangle[i], triangle[(i + 1) % 3]}];
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(edges.count({edge.second, edge.first}), 1u);
  }
}

TEST(Skin, is_closed_every_edge_between_two_triangles_that_pass_it_in_opposite_ways) {
  expect_closed(Skin::detailed());
  expect_closed(Skin::human());
  expect_closed(Skin::outline());
}

TEST(Skin, is_one_piece_without_a_hole) {
  for (const Skin* skin : {&Skin::detailed(), &Skin::human(), &Skin::outline()}) {
    const auto vertices = static_cast<long>(skin->size()),
               triangles = static_cast<long>(skin->triangles().size());
    EXPECT_EQ(vertices - triangles * 3 / 2 + triangles, 2);  // Euler's formula for a sphere
  }
}

TEST(Skin, is_as_fine_as_it_is_asked_to_be_and_finer_where_it_is_looked_at) {
  EXPECT_GE(Skin::detailed().triangles().size(), 8000u);
  EXPECT_NEAR(static_cast<double>(modelled_skin(1000).triangles.size()), 1000.0, 20.0);
  const Skin& skin = Skin::human();
  int tips = 0, rest = 0;
  for (std::size_t v = 0; v < skin.size(); ++v) {
    const auto shares = capsule_shares(skin.rest()[v]);
    double tip = 0.0;
    for (int finger = 0; finger < kFingers; ++finger)
      tip += shares[static_cast<std::size_t>(capsule_index(finger, 3))];
    ++(tip > 0.5 ? tips : rest);
  }
  EXPECT_GT(5 * tips, rest);  // of an eighth of the surface
}

/// Numbers as a compiler may round them otherwise; the rest to the bit.
void expect_same(const SkinModel& made, const SkinModel& shipped) {
  constexpr float kRounding = 1e-5f;  // of lengths [m], fractions and colours
  ASSERT_EQ(made.triangles, shipped.triangles);
  ASSERT_EQ(made.ends, shipped.ends);
  ASSERT_EQ(made.rest.size(), shipped.rest.size());
  ASSERT_EQ(made.looks.size(), shipped.looks.size());
  for (std::size_t v = 0; v < made.rest.size(); ++v) {
    EXPECT_LT((made.rest[v] - shipped.rest[v]).norm(), kRounding);
    EXPECT_EQ(made.looks[v].capsule, shipped.looks[v].capsule);
    EXPECT_LT((made.looks[v].colour - shipped.looks[v].colour).abs().maxCoeff(), kRounding);
  }
  ASSERT_EQ(made.influences.size(), shipped.influences.size());
  for (std::size_t i = 0; i < made.influences.size(); ++i) {
    const SkinModel::Influence &a = made.influences[i], &b = shipped.influences[i];
    EXPECT_EQ(a.bone, b.bone);
    EXPECT_NEAR(a.weight, b.weight, kRounding);
    EXPECT_NEAR(a.along, b.along, kRounding);
    EXPECT_LT((a.beyond - b.beyond).norm(), kRounding);
    EXPECT_LT((a.normal - b.normal).norm(), 100.0f * kRounding);  // by differences of the shape over 0.1 mm
  }
}

TEST(Skin, that_ships_is_what_make_skin_gives) {
  expect_same(skinned(modelled_skin(kDetailedTriangles), true), Skin::detailed().model());
  expect_same(skinned(modelled_skin(kHumanTriangles), false), Skin::human().model());
  expect_same(skinned(modelled_skin(kOutlineTriangles), false), Skin::outline().model());
}

TEST(Skin, rest_hand_posed_is_the_rest_hand) {
  const Hand rest = hand_in([] {
    HandPosture posture = HandPosture::Zero();
    posture.row(kAbduction) << 0.0, 6.0, 1.0, -5.0, -10.0;
    return HandPosture(M_PI / 180.0 * posture);
  }());
  const SkinSurface surface = skin_of(rest);
  for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
    const Vector3& vertex = Skin::human().rest()[v];
    EXPECT_LT((surface.vertices[v] - vertex).norm(), 1e-7);              // float32 places on bones
    EXPECT_LT((surface.normals[v] - skin_normal(vertex)).norm(), 1e-4);  // no facets
  }
}

TEST(Skin, fingers_are_as_thick_as_their_capsules_and_no_thicker) {
  const Hand hand = hand_in(relaxed_posture());
  const SkinSurface surface = skin_of(hand);
  for (int finger = 0; finger < kFingers; ++finger) {
    for (int bone = 2; bone < kBonesPerFinger; ++bone) {
      const auto index = static_cast<std::size_t>(capsule_index(finger, bone));
      const Capsule& capsule = hand.capsules[index];
      for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
        if (capsule_shares(Skin::human().rest()[v])[index] < 0.99f) continue;
        const double radii = testing::distance_to_axis(capsule, surface.vertices[v]) / capsule.radius;
        EXPECT_LT(radii, 1.05);  // joints are a little thicker
        EXPECT_GT(radii, 0.70);  // the back of the fingertip is slimmer
      }
    }
  }
}

TEST(Skin, what_touches_is_seen_to_touch) {
  const Hand hand = hand_in(open_posture());
  const SkinSurface surface = skin_of(hand);
  for (int finger = 1; finger < kFingers; ++finger) {  // the thumb's palm side is not below
    const Capsule& tip = hand.capsules[static_cast<std::size_t>(capsule_index(finger, 3))];
    const Vector3 along = (tip.end - tip.start).normalized();
    const Vector3 down = (-Vector3::UnitZ() + along.z() * along).normalized();
    double sum = 0.0;
    int count = 0;
    for (const double forward : {-1.0, -0.5, 0.0, 0.3, 0.6, 0.9}) {  // along the pad, then round the end
      const double angle = std::max(0.0, forward);
      const Vector3 on_axis = forward < 0.0 ? tip.axis_point(1.0 + 0.5 * forward) : tip.end;
      const Vector3 out = std::cos(angle) * down + std::sin(angle) * along;
      const double outside = tip.radius - testing::reach(surface, on_axis, out);
      EXPECT_LT(outside, 0.0009);   // a gap as narrow is not seen
      EXPECT_GT(outside, -0.0004);  // nor is as much of the skin in what it touches
      sum += outside;
      ++count;
    }
    EXPECT_NEAR(sum / count, 0.0, 0.0004);
  }
}

TEST(Skin, left_hand_is_the_mirror_image_of_the_right) {
  const SkinSurface right = skin_of(hand_in(pointing_posture(), Side::right));
  const SkinSurface left = skin_of(hand_in(pointing_posture(), Side::left));
  const Vector3 mirror(1.0, -1.0, 1.0);
  for (std::size_t v = 0; v < right.vertices.size(); ++v) {
    EXPECT_LT((left.vertices[v] - mirror.cwiseProduct(right.vertices[v])).norm(), 1e-6);  // float32 wrist
    EXPECT_LT((left.normals[v] - mirror.cwiseProduct(right.normals[v])).norm(), 1e-3);
  }
}

TEST(Skin, grows_with_the_hand) {
  const SkinSurface adult = skin_of(complete_hand(adult_hand(Side::right), Pose{}));
  for (const double factor : {0.6, 1.4}) {
    const SkinSurface other = skin_of(complete_hand(scaled(adult_hand(Side::right), factor), Pose{}));
    for (std::size_t v = 0; v < adult.vertices.size(); ++v) {
      EXPECT_LT((other.vertices[v] - factor * adult.vertices[v]).norm(), 1e-6);  // float32 sizes
    }
  }
}

TEST(Skin, goes_with_the_hand) {
  const Pose pose{Vector3(0.3, -0.2, 0.5), Quaternion(0.5, 0.5, -0.5, 0.5)};
  const SkinSurface here = skin_of(complete_hand(adult_hand(Side::left), Pose{}));
  const SkinSurface there = skin_of(complete_hand(adult_hand(Side::left), pose));
  for (std::size_t v = 0; v < here.vertices.size(); ++v) {
    EXPECT_LT((there.vertices[v] - pose * here.vertices[v]).norm(), 1e-6);  // float32 wrist
  }
}

TEST(Skin, no_triangle_turns_over_in_a_fist) {
  for (const Side side : {Side::left, Side::right}) {
    for (const HandPosture& posture :
         {fist_posture(), open_posture(), flat_posture(), relaxed_posture(), pointing_posture()}) {
      EXPECT_EQ(flipped_triangles(side, skin_of(hand_in(posture, side))), 0);
    }
  }
}

TEST(Skin, stays_on_the_bones_in_every_motion) {
  for (const std::string& motion : motion_names()) {
    for (const char* side : {"left", "right"}) {
      SyntheticHandOptions options;
      options.motion = motion;
      options.side = side;
      options.rate = 30.0;
      for (const JointsFrame& frame : record_motion(options)) {
        for (const HandJoints& joints : frame.hands) {
          const Hand hand = complete_hand(joints, default_device_mount());
          const SkinSurface surface = skin_of(hand);
          ASSERT_TRUE(finite(surface)) << motion;
          ASSERT_LT(farthest_from_bones(hand, surface), 0.5) << motion;  // the web of the thumb
          ASSERT_EQ(flipped_triangles(hand.side, surface), 0) << motion;
        }
      }
    }
  }
}

TEST(Skin, needs_every_bone_but_the_thumbs_metacarpal) {
  SkinSurface surface;
  Hand hand = complete_hand(adult_hand(Side::right), Pose{});
  hand.capsules[static_cast<std::size_t>(capsule_index(4, 2))] = {};
  EXPECT_FALSE(Skin::human().pose(hand, surface));
  EXPECT_TRUE(surface.vertices.empty());
}

TEST(Skin, keeps_its_memory) {
  SkinSurface surface = skin_of(hand_in(flat_posture()));
  const Vector3 *vertices = surface.vertices.data(), *normals = surface.normals.data();
  ASSERT_TRUE(Skin::human().pose(hand_in(fist_posture()), surface));
  EXPECT_EQ(surface.vertices.data(), vertices);
  EXPECT_EQ(surface.normals.data(), normals);
}

}  // namespace
}  // namespace mrhi
