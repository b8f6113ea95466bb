#include "shown_markers.h"

namespace mrhi {
namespace {

/// Of an arrow that points down: where its tip is and where it begins [m].
struct Ends {
  double tip = 1e9, begin = -1e9;

  explicit Ends(const Marker& arrow) {
    for (const auto& point : arrow.points) tip = std::min(tip, point.z), begin = std::max(begin, point.z);
  }
  double length() const { return begin - tip; }
};

TEST(ContactMarkers, arrows_push_as_the_force_does_behind_the_finger_and_are_longer_for_more) {
  Shown shown;
  Contact contact;
  contact.point = {0.1, 0.2, 0.3};
  contact.radius = 0.01;
  double before = 0.0;
  for (const double newtons : {0.2, 1.0, 5.0, 100.0}) {
    contact.force = {0, 0, -newtons};
    shown.result.contacts = {contact};
    shown.update();
    const Ends arrow(shown.first("forces"));
    EXPECT_GT(arrow.tip, contact.point.z() + 2.0 * contact.radius);
    EXPECT_LT(arrow.tip, contact.point.z() + 2.0 * contact.radius + 0.01);  // not far from the finger
    EXPECT_GT(arrow.length(), before);
    EXPECT_LT(arrow.length(), 0.12);
    before = arrow.length();
  }
}

TEST(ContactMarkers, an_arrow_tells_1_N_from_5_N_and_numbers_stand_at_its_end) {
  Shown shown;
  Contact contact;
  contact.radius = 0.01;
  std::vector<double> lengths;
  for (const auto& [newtons, text] : {std::pair(1.0, "1.0 N"), std::pair(5.0, "5.0 N")}) {
    contact.force = {0, 0, -newtons};
    shown.result.contacts = {contact};
    shown.update();
    const Ends arrow(shown.first("forces"));
    const Marker& number = shown.first("newtons");
    lengths.push_back(arrow.length());
    EXPECT_EQ(number.text, text);
    EXPECT_GT(number.pose.position.z, arrow.begin);
    EXPECT_LT(number.pose.position.z, arrow.begin + 0.02);
  }
  EXPECT_GE(lengths[1], 2.0 * lengths[0]);
}

TEST(ContactMarkers, an_arrow_of_its_own_colour_pulls_where_grasp_assist_supports_an_object) {
  Shown shown;
  shown.state.bodies[0].pose.position = {0, 0, 0.5};
  const double half_height = std::get<Box>(shown.scene.bodies[0].shapes[0].shape).half_extents.z();
  shown.result.assists = {{0, 0, {0, 0, 1.5}}};
  shown.update();
  const Marker& arrow = shown.first("forces");
  EXPECT_EQ(arrow.color, PictureStyle().assist);
  const Ends ends(arrow);
  EXPECT_NEAR(ends.tip, 0.5 + half_height, 0.003);  // Ends is of an arrow that points down
  EXPECT_GT(ends.length(), 0.03);
  EXPECT_EQ(shown.first("newtons").text, "1.5 N");
  shown.result.assists = {{0, 0, {0, 0, 0.01}}};
  EXPECT_EQ(shown.update()["forces"], 0);  // too small to see
}

// rviz's own arrows are black where its light does not reach: from behind a hand that is all that is seen.
TEST(ContactMarkers, arrows_are_bright_from_every_side_and_closed) {
  for (const Vector3& force : {Vector3(3, 0, 0), Vector3(-1, 2, 0.5), Vector3(0, 0, -4)}) {
    Shown shown;
    Contact contact;
    contact.radius = 0.01;
    contact.force = force;
    shown.result.contacts = {contact};
    shown.update();
    const Marker& arrow = shown.first("forces");
    ASSERT_EQ(arrow.colors.size(), arrow.points.size());
    for (const auto& colour : arrow.colors) EXPECT_GT(std::min({colour.r, colour.g, colour.b}), 0.4f);
    Vector3 area = Vector3::Zero();
    double volume = 0.0;
    for (std::size_t i = 0; i + 2 < arrow.points.size(); i += 3) {
      std::array<Vector3, 3> p;
      for (std::size_t j = 0; j < 3; ++j)
        p[j] = {arrow.points[i + j].x, arrow.points[i + j].y, arrow.points[i + j].z};
      area += 0.5 * (p[1] - p[0]).cross(p[2] - p[0]);
      volume += p[0].dot(p[1].cross(p[2])) / 6.0;
    }
    EXPECT_LT(area.norm(), 1e-12) << "of a closed surface all outward areas are nothing together";
    EXPECT_GT(volume, 1e-7) << "and its corners go round outwards";
  }
}

TEST(ContactMarkers, sticking_and_slipping_rings_differ_in_colour_and_an_impact_has_none_of_them) {
  Shown shown;
  Contact contact;
  contact.radius = 0.01;
  const auto ring = [&] {
    shown.result.contacts = {contact};
    shown.update();
    EXPECT_EQ(shown.first("contacts").points.size(), 1u);
    const auto c = shown.first("friction").colors.at(0);
    return std::array<float, 3>{c.r, c.g, c.b};
  };
  const auto sticking = ring();
  contact.friction = Friction::slipping;
  const auto slipping = ring();
  EXPECT_NE(sticking, slipping);
  EXPECT_GT(slipping[0] + slipping[1],
            sticking[0] + sticking[1] + 0.5f);  // also where hues are not told apart
  contact.impulse = Vector3::UnitX();
  shown.result.contacts = {contact};
  EXPECT_EQ(shown.update()["friction"], 0);
}

TEST(ContactMarkers, the_share_of_the_friction_limit_is_a_colour_from_blue_to_orange) {
  Shown shown;
  Contact contact;
  contact.radius = 0.01;
  float blue_before = 2.0f;                          // less red: orange has none of it
  for (const double tangential : {0.0, 0.4, 0.8}) {  // of 0.8, the limit at a push of 1 N
    contact.force = {tangential, 0.0, -1.0};
    shown.result.contacts = {contact};
    shown.update();
    const auto c = shown.first("share").colors.at(0);
    EXPECT_LT(c.b - c.r, blue_before);
    blue_before = c.b - c.r;
  }
  EXPECT_LT(blue_before, -0.5f);
}

}  // namespace
}  // namespace mrhi
