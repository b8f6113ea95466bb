#include <gtest/gtest.h>

#include "mr_hand_interaction/response/contact_model.h"
#include "mr_hand_interaction/scene/scene_loader.h"
#include "support/pinch_scene.h"

namespace mrhi {
namespace {

using namespace testing;

constexpr double kFingerRadius = 0.008, kHalfRail = 0.01, kGripOverlap = 0.002;  // [m]
const Vector3 kCentre(0.0, 0.25, 0.3);

/// Fingertips along a rail on its two sides, where the crate is when it has come as far as `by`.
Hand on_rail(std::uint32_t id, double x, const Vector3& by, double closed) {
  const Vector3 place = kCentre + Vector3(x, 0, 0) + by, along(0, 0, 0.015);
  const double off = kHalfRail + kFingerRadius + (1.0 - closed) * 0.01 - closed * kGripOverlap;
  Hand hand;
  hand.id = id;
  hand.side = id == 1 ? Side::left : Side::right;
  for (const int side : {1, -1}) {
    const Vector3 tip = place + Vector3(0, side * off, 0);
    add_finger(hand, capsule_index(side > 0 ? 1 : 0, 3), tip - along, tip + along, kFingerRadius);
  }
  hand.palm = {place, Quaternion::Identity()};
  return hand;
}

class Crate : public ::testing::Test {
 protected:
  Crate() : simulation_(crate(), unfiltered(ContactModelKind::implicit)) {}

  static Scene crate() {
    SceneOptions options;
    options.default_material = default_material(unfiltered(ContactModelKind::implicit));
    return load_scene("config/scenes/crate.urdf", options);
  }
  const Pose& pose() const { return simulation_.state().bodies[0].pose; }
  /// The crate is to come as far as `by` says; each hand is closed as far as its number says.
  template <typename By, typename Closed>
  void run(double from, double to, By&& by, Closed&& closed) {
    for (double t = from; t < to; t += 1.0 / 120.0) {
      const auto [left, right] = closed(t);
      HandFrame frame{at(t), {}};
      frame.hands.push_back(on_rail(1, -0.49, by(t), left));
      frame.hands.push_back(on_rail(2, 0.49, by(t), right));
      ASSERT_EQ(simulation_.advance(frame), Rejection::none);
      worst_ = std::max(worst_, (pose().position - kCentre - by(t)).norm());
      turned_ = std::max(turned_, pose().orientation.angularDistance(Quaternion::Identity()));
    }
  }

  Simulation simulation_;
  double worst_ = 0.0, turned_ = 0.0;
};

Vector3 way(double t) {
  return smooth(t - 1.0, 3.0) * Vector3(0.1, 0.0, 0.1);
}

/// 20 kg that speed up by some 0.1 m/s^2 take 2 N: fingertips of 2000 N/m give by less than a millimetre.
TEST_F(Crate, of_a_metre_and_20_kg_follows_two_hands_on_its_rails) {
  run(0.0, 6.0, way, [](double t) { return std::make_pair(smooth(t, 0.5), smooth(t, 0.5)); });
  EXPECT_LT(worst_, 0.003);
  EXPECT_LT(turned_, 0.01);
  EXPECT_LT(object_twist(simulation_, 0).linear.norm(), 1e-3);
}

/// Carried by the left hand, then by both, then by the right one alone. By one rail it is carried half a
/// metre off its middle, so that it turns a little as it speeds up and slows down.
TEST_F(Crate, is_handed_over_on_its_way) {
  run(
      0.0, 8.0, [](double t) { return Vector3(smooth(t - 0.7, 6.0) * Vector3(0.05, 0.0, 0.05)); },
      [](double t) { return std::make_pair(smooth(t, 0.5) - smooth(t - 4.0, 0.5), smooth(t - 2.5, 0.5)); });
  EXPECT_LT(worst_, 0.02);  // measured are half of these
  EXPECT_LT(turned_, 0.1);
  EXPECT_LT(object_twist(simulation_, 0).linear.norm(), 5e-3);
}

}  // namespace
}  // namespace mrhi
