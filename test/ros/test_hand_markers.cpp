#include "shown_markers.h"

#include <algorithm>

#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "rendering/skin.h"

namespace mrhi {
namespace {

TEST(HandMarkers, a_hand_is_one_skin_and_hands_that_go_are_deleted) {
  Shown shown;
  shown.see_hands(2);
  auto added = shown.update();
  EXPECT_EQ(added["hand"], 2);
  const int capsules = added["capsules"];
  EXPECT_GT(capsules, 2 * kPhalanges);
  const Marker& skin = shown.first("hand");
  EXPECT_EQ(skin.type, Marker::TRIANGLE_LIST);
  EXPECT_EQ(skin.colors.size(), skin.points.size());
  shown.see_hands(1);
  added = shown.update();
  EXPECT_EQ(added["hand"], 1);
  EXPECT_EQ(shown.deleted("hand"), 1);
  EXPECT_EQ(shown.deleted("capsules"), capsules / 2);
  shown.update();
  EXPECT_EQ(shown.deleted("hand"), 0);
}

// Then it looks right from every direction, whatever the order in which a viewer draws triangles.
TEST(HandMarkers, the_skin_is_opaque_and_closed) {
  for (const Side side : {Side::left, Side::right}) {
    Shown shown;
    shown.see_hands(1, side);
    shown.update();
    const Marker& skin = shown.first("hand");
    EXPECT_EQ(skin.points.size(), 3 * Skin::human().triangles().size());
    Vector3 area = Vector3::Zero();  // of a closed surface it is none
    for (std::size_t i = 0; i < skin.points.size(); i += 3) {
      const Vector3 a = from_message(skin.points[i]);
      area += 0.5 * (from_message(skin.points[i + 1]) - a).cross(from_message(skin.points[i + 2]) - a);
    }
    EXPECT_LT(area.norm(), 1e-9);  // [m^2], of rounding
    for (const auto& colour : skin.colors) EXPECT_EQ(colour.a, 1.0f);
  }
}

TEST(HandMarkers, triangles_of_either_hand_are_counter_clockwise_from_outside) {
  for (const Side side : {Side::left, Side::right}) {
    Shown shown;
    shown.see_hands(1, side);
    shown.update();
    const auto& points = shown.first("hand").points;
    double six_volumes = 0.0;
    for (std::size_t i = 0; i < points.size(); i += 3) {
      six_volumes +=
          from_message(points[i]).dot(from_message(points[i + 1]).cross(from_message(points[i + 2])));
    }
    EXPECT_GT(six_volumes, 0.0);
  }
}

TEST(HandMarkers, a_hand_with_a_bone_missing_is_drawn_as_capsules) {
  Shown shown;
  shown.see_hands(1);
  shown.result.rendered[0].hand.capsules[static_cast<std::size_t>(capsule_index(3, 2))] = {};
  const auto added = shown.update();
  EXPECT_EQ(added.at("hand"), added.at("capsules"));
  EXPECT_GT(added.at("hand"), kPhalanges);
}

TEST(HandMarkers, the_ghost_is_seen_where_the_tracked_hand_is_elsewhere_and_more_so_the_farther) {
  Shown shown;
  shown.see_hands(1);
  EXPECT_EQ(shown.update()["ghost"], 0);
  const auto tip = static_cast<std::size_t>(capsule_index(1, 3));
  float before = 0.0f;
  for (const double shift : {0.002, 0.006, 0.012}) {
    shown.result.tracked[0] = shown.result.rendered[0].hand;
    shown.result.tracked[0].capsules[tip].end.z() -= shift;
    const bool seen = shift > 0.003;
    ASSERT_EQ(shown.update()["ghost"], seen);
    if (!seen) continue;
    const Marker& ghost = shown.first("ghost");
    EXPECT_LT(ghost.points.size(), shown.first("hand").points.size() / 10);  // the fingertip alone
    float most = 0.0f;
    for (const auto& color : ghost.colors) most = std::max(most, color.a);
    EXPECT_GT(most, before);
    before = most;
  }
}

TEST(HandMarkers, what_touches_is_highlighted) {
  Shown shown;
  shown.see_hands(1);
  shown.update();
  const auto before = shown.first("hand").colors;
  const int touching = capsule_index(1, 3);
  RenderedHand& rendered = shown.result.rendered[0];
  const auto pad = static_cast<std::size_t>(touching);
  rendered.touching[pad] = true;
  rendered.pressed[pad] = {5.0, rendered.hand.capsules[pad].end};
  shown.update();
  const auto& after = shown.first("hand").colors;
  int changed = 0;
  const Hand& hand = rendered.hand;
  const auto& points = shown.first("hand").points;
  for (std::size_t i = 0; i < after.size(); ++i) {
    if (after[i].g == before[i].g) continue;
    EXPECT_LT((from_message(points[i]) - hand.capsules[pad].end).norm(), 2.5 * hand.capsules[pad].radius);
    ++changed;
  }
  EXPECT_GT(changed, 100);
}

}  // namespace
}  // namespace mrhi
