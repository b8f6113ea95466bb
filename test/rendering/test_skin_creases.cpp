#include <gtest/gtest.h>

#include <map>

#include "modelling/skin_shape.h"
#include "rendering/skin_checks.h"
#include "rendering/skin_creases.h"
#include "rendering/skin_rig.h"
#include "support/postures.h"

namespace mrhi {
namespace {

using testing::distance_to_axis;
using testing::hand_in;
using testing::open_posture;

/// Of two triangles. Its ends are where it crosses edges of the skin's triangles; the last of a crease has
/// none left of its width.
struct Strip {
  std::array<Vector3, 2> ends;
  std::array<double, 2> widths;
  Vector3 normal;
};

std::vector<SkinCreases::Corner> corners_on(const Hand& hand, const Rgb& skin = Rgb::Ones()) {
  static const SkinCreases creases(Skin::human());
  SkinSurface surface;
  EXPECT_TRUE(Skin::human().pose(hand, surface));
  std::vector<SkinCreases::Corner> corners;
  creases.pose(surface, std::vector<Rgb>(surface.vertices.size(), skin), corners);
  return corners;
}

std::vector<Strip> strips_on(const Hand& hand) {
  std::vector<Strip> strips;
  const auto corners = corners_on(hand);
  EXPECT_EQ(corners.size() % 6, 0u);
  for (std::size_t i = 0; i + 5 < corners.size(); i += 6) {
    const Vector3 &a = corners[i].place, &b = corners[i + 1].place, &c = corners[i + 2].place,
                  &d = corners[i + 5].place;
    strips.push_back({{0.5 * (a + d), 0.5 * (b + c)},
                      {(a - d).norm(), (b - c).norm()},
                      (c - a).cross(d - b).normalized()});
  }
  return strips;
}

/// In micrometres, so that what is the same to rounding is the same.
std::array<long, 3> rounded(const Vector3& place) {
  return {std::lround(1e6 * place.x()), std::lround(1e6 * place.y()), std::lround(1e6 * place.z())};
}

Hand rest() {
  HandPosture posture = HandPosture::Zero();
  posture.row(kAbduction) << 0.0, 6.0, 1.0, -5.0, -10.0;
  return hand_in(M_PI / 180.0 * posture);
}

/// From the nearest place on an edge of the rest hand's triangles.
Vector3 off_edges(const Vector3& place) {
  const auto& vertices = Skin::human().rest();
  Vector3 least = Vector3::Ones();
  for (const auto& triangle : Skin::human().triangles()) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3& from = vertices[static_cast<std::size_t>(triangle[i])];
      const Vector3 along = vertices[static_cast<std::size_t>(triangle[(i + 1) % 3])] - from;
      const double s = std::clamp((place - from).dot(along) / along.squaredNorm(), 0.0, 1.0);
      const Vector3 off = place - from - s * along;
      if (off.squaredNorm() < least.squaredNorm()) least = off;
    }
  }
  return least;
}

bool is_on_thumb(const Vector3& place) {
  double thumb = 1.0, others = 1.0;
  for (int c = 0; c < kPhalanges; ++c) {
    if (!rest().has(c)) continue;
    double& nearest = finger_of(c) == 0 ? thumb : others;
    nearest = std::min(nearest, distance_to_axis(rest().capsules[static_cast<std::size_t>(c)], place));
  }
  return thumb < others;
}

TEST(SkinCreases, are_on_the_side_of_the_palm_upon_the_triangles) {
  for (const Strip& strip : strips_on(rest())) {
    for (const std::size_t i : {0, 1}) {
      if (strip.widths[i] < 1e-4) continue;
      const Vector3& end = strip.ends[i];
      EXPECT_LT(off_edges(end).norm(), 0.0002) << end.transpose();  // 0.15 mm
      EXPECT_GT(off_edges(end).dot(strip.normal), 0.0) << end.transpose();
      const int finger = is_on_thumb(end) ? 0 : 1;
      const Vector3 back = rest_hand().rig[static_cast<std::size_t>(capsule_index(finger, 1))].axes.col(2);
      EXPECT_LT(skin_normal(end).dot(back), 0.3) << end.transpose();
    }
  }
}

TEST(SkinCreases, cross_every_finger_at_its_joints) {
  const auto strips = strips_on(rest());
  for (int finger = 0; finger < kFingers; ++finger) {
    for (int b = 2; b < kBonesPerFinger; ++b) {
      const SkinBone& bone = rest_hand().rig[static_cast<std::size_t>(capsule_index(finger, b))];
      double left = 0.0, right = 0.0;
      for (const Strip& strip : strips) {
        for (const Vector3& end : strip.ends) {
          const Vector3 place = bone.axes.transpose() * (end - bone.start) / bone.radius;
          if (std::abs(place.x()) > 0.1 || place.norm() > 1.3) continue;
          left = std::min(left, place.y()), right = std::max(right, place.y());
        }
      }
      EXPECT_LT(left, -0.5) << finger << " " << b;
      EXPECT_GT(right, 0.5) << finger << " " << b;
    }
  }
}

TEST(SkinCreases, are_lines_without_a_gap_however_the_hand_is_bent) {
  const int creases = 2 * kFingers + (kFingers - 1) + 3;
  for (const HandPosture& posture : {open_posture(), relaxed_posture(), testing::fist_posture()}) {
    std::map<std::array<long, 3>, int> met;
    for (const Strip& strip : strips_on(hand_in(posture)))
      for (const Vector3& end : strip.ends) ++met[rounded(end)];
    int loose = 0;
    for (const auto& [place, times] : met) loose += times == 1;
    EXPECT_EQ(loose, 2 * creases);
  }
}

TEST(SkinCreases, face_away_from_either_hand) {
  for (const Side side : {Side::left, Side::right}) {
    const Hand hand = hand_in(relaxed_posture(), side);
    int on_fingers = 0;
    for (const Strip& strip : strips_on(hand)) {
      for (int finger = 0; finger < kFingers; ++finger) {
        const Capsule& tip = hand.capsules[static_cast<std::size_t>(capsule_index(finger, 2))];
        const Vector3 from = strip.ends[0] - tip.start;
        if (from.norm() > 1.2 * tip.radius) continue;
        EXPECT_GT(strip.normal.dot(from.normalized()), 0.2);
        ++on_fingers;
      }
    }
    EXPECT_GT(on_fingers, 3 * kFingers);
  }
}

TEST(SkinCreases, are_the_skin_s_colour_but_darker) {
  const Rgb skin(0.9f, 0.5f, 0.25f);
  for (const SkinCreases::Corner& corner : corners_on(rest(), skin)) {
    EXPECT_TRUE((corner.colour < skin).all());
    EXPECT_TRUE((corner.colour > 0.5f * skin).all());
  }
}

}  // namespace
}  // namespace mrhi
