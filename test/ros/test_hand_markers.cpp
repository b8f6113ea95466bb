#include "shown_markers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "rendering/skin.h"

namespace mrhi {
namespace {

constexpr int kWristSides = 6;
constexpr int kParts = 1 + kWristSides;  // the skin, the sides of its wrist

/// The skin, the wrist's sides.
std::vector<const Marker*> parts_of(const Shown& shown) {
  std::vector<const Marker*> parts;
  for (const Marker& marker : shown.array.markers)
    if (marker.ns == "hand") parts.push_back(&marker);
  return parts;
}

/// In world; markers are not turned.
Vector3 place_of(const Marker& marker, std::size_t i) {
  return from_message(marker.pose.position) + from_message(marker.points[i]);
}

TEST(HandMarkers, a_hand_is_one_skin_and_hands_that_go_are_deleted) {
  Shown shown;
  shown.see_hands(2);
  auto added = shown.update();
  EXPECT_EQ(added["hand"], 2 * kParts);
  const int capsules = added["capsules"];
  EXPECT_GT(capsules, 2 * kPhalanges);
  const Marker& skin = shown.first("hand");
  EXPECT_EQ(skin.type, Marker::TRIANGLE_LIST);
  EXPECT_EQ(skin.colors.size(), skin.points.size());
  shown.see_hands(1);
  added = shown.update();
  EXPECT_EQ(added["hand"], kParts);
  EXPECT_EQ(shown.deleted("hand"), kParts);
  EXPECT_EQ(shown.deleted("capsules"), capsules / 2);
  shown.update();
  EXPECT_EQ(shown.deleted("hand"), 0);
}

TEST(HandMarkers, the_skin_is_opaque_and_closed_and_the_wrist_ends_in_nothing) {
  for (const Side side : {Side::left, Side::right}) {
    Shown shown;
    shown.see_hands(1, side);
    shown.update();
    const std::vector<const Marker*> parts = parts_of(shown);
    ASSERT_EQ(parts.size(), std::size_t{kParts});
    const Marker& skin = *parts[0];
    Marker wrist;
    for (std::size_t part = 1; part <= kWristSides; ++part) {
      wrist.points.insert(wrist.points.end(), parts[part]->points.begin(), parts[part]->points.end());
      wrist.colors.insert(wrist.colors.end(), parts[part]->colors.begin(), parts[part]->colors.end());
    }
    EXPECT_GE(skin.points.size() + wrist.points.size(), 3 * Skin::human().triangles().size());
    EXPECT_LT(wrist.points.size(), skin.points.size() / 3);
    Vector3 area = Vector3::Zero();  // of a closed surface it is none
    for (std::size_t i = 0; i < skin.points.size(); i += 3) {
      const Vector3 a = from_message(skin.points[i]);
      area += 0.5 * (from_message(skin.points[i + 1]) - a).cross(from_message(skin.points[i + 2]) - a);
    }
    EXPECT_LT(area.norm(), 1e-9);  // [m^2], of rounding
    for (const auto& colour : skin.colors) EXPECT_EQ(colour.a, 1.0f);
    const auto by_alpha = [](const auto& a, const auto& b) { return a.a < b.a; };
    const auto [least, most] = std::minmax_element(wrist.colors.begin(), wrist.colors.end(), by_alpha);
    EXPECT_LT(least->a, 0.01f);
    EXPECT_EQ(most->a, 1.0f);
  }
}

using Triangle = std::array<Vector3, 3>;

std::vector<Triangle> triangles_of(const Marker& marker) {
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i < marker.points.size(); i += 3)
    triangles.push_back({place_of(marker, i), place_of(marker, i + 1), place_of(marker, i + 2)});
  return triangles;
}

/// How often a surface goes round a point: 1 inside, 0 outside (van Oosterom & Strackee 1983).
double turns_round(const Vector3& point, const std::vector<Triangle>& surface) {
  double angle = 0.0;
  for (const Triangle& triangle : surface) {
    const Vector3 a = triangle[0] - point, b = triangle[1] - point, c = triangle[2] - point;
    const double x = a.norm(), y = b.norm(), z = c.norm();
    angle += 2.0 * std::atan2(a.dot(b.cross(c)), x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y);
  }
  return angle / (4.0 * M_PI);
}

// A lid that stands out is seen as a row of dark teeth at the wrist.
TEST(HandMarkers, the_lid_below_the_wrist_lies_within_the_hand) {
  Shown shown;
  shown.see_hands(1);
  shown.update();
  const std::vector<const Marker*> parts = parts_of(shown);
  ASSERT_EQ(parts.size(), std::size_t{kParts});
  std::vector<Triangle> surface = triangles_of(*parts[0]), wrist;
  for (std::size_t part = 1; part <= kWristSides; ++part)
    for (const Triangle& triangle : triangles_of(*parts[part])) wrist.push_back(triangle);
  const std::size_t skin = Skin::human().triangles().size() - wrist.size();
  ASSERT_GT(surface.size(), skin + 10);
  const std::vector<Triangle> lid(surface.begin() + static_cast<std::ptrdiff_t>(skin), surface.end());
  surface.resize(skin);
  surface.insert(surface.end(), wrist.begin(), wrist.end());
  for (const Triangle& triangle : lid) {
    const Vector3 centre = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
    EXPECT_GT(turns_round(centre, surface), 0.5) << (centre - triangle[0]).transpose();
  }
}

// rviz draws what is translucent from the farthest marker's place to the nearest: where the wrist's far side
// stood before its near one, a step of tone went across it.
TEST(HandMarkers, the_sides_of_the_wrist_that_face_the_eye_are_nearer_to_it_than_those_that_do_not) {
  Shown shown;
  shown.see_hands(1);
  shown.update();
  const std::vector<const Marker*> parts = parts_of(shown);
  Vector3 wrist = Vector3::Zero();
  for (std::size_t part = 1; part <= kWristSides; ++part)
    wrist += from_message(parts[part]->pose.position) / kWristSides;
  for (const Vector3& towards : {Vector3(0, 1, 0), Vector3(0, -1, 0), Vector3(0, 0, 1), Vector3(0, 0, -1)}) {
    const Vector3 eye = wrist + 0.4 * towards;
    double farthest_facing = 0.0, nearest_averted = 1.0;
    for (std::size_t part = 1; part <= kWristSides; ++part) {
      Vector3 area = Vector3::Zero();
      for (const Triangle& t : triangles_of(*parts[part])) area += (t[1] - t[0]).cross(t[2] - t[0]);
      const Vector3 place = from_message(parts[part]->pose.position);
      const double facing = area.normalized().dot((eye - place).normalized());
      if (facing > 0.3) farthest_facing = std::max(farthest_facing, (eye - place).norm());
      if (facing < -0.3) nearest_averted = std::min(nearest_averted, (eye - place).norm());
    }
    ASSERT_GT(farthest_facing, 0.0);
    ASSERT_LT(nearest_averted, 1.0);
    EXPECT_LT(farthest_facing, nearest_averted) << towards.transpose();
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
