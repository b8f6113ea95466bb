#include "shown_markers.h"

namespace mrhi {
namespace {

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
    const Marker& arrow = shown.first("forces");
    ASSERT_EQ(arrow.points.size(), 2u);
    EXPECT_GT(arrow.points[1].z, contact.point.z() + 2.0 * contact.radius);
    const double length = arrow.points[0].z - arrow.points[1].z;
    EXPECT_GT(length, before);
    EXPECT_LT(length, 0.12);
    before = length;
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
    const Marker &arrow = shown.first("forces"), &number = shown.first("newtons");
    lengths.push_back(arrow.points[0].z - arrow.points[1].z);
    EXPECT_EQ(number.text, text);
    EXPECT_GT(number.pose.position.z, arrow.points[0].z);
    EXPECT_LT(number.pose.position.z, arrow.points[0].z + 0.02);
  }
  EXPECT_GE(lengths[1], 2.0 * lengths[0]);
}

TEST(ContactMarkers, sticking_slipping_and_striking_differ_in_colour) {
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
  contact.impulse = Vector3::UnitX();
  const auto striking = ring();
  EXPECT_NE(sticking, slipping);
  EXPECT_NE(slipping, striking);
  EXPECT_GT(slipping[0] + slipping[1],
            sticking[0] + sticking[1] + 0.5f);  // also where hues are not told apart
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
