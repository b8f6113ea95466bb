#include <gtest/gtest.h>

#include "mr_hand_interaction/response/contact_model.h"
#include "mr_hand_interaction/scene/scene_loader.h"
#include "support/joints.h"
#include "support/pinch_scene.h"

namespace mrhi {
namespace {

using namespace testing;

constexpr double kRadius = 0.008;  // of a fingertip [m]

/// The shipped panel, worked by fingertips that are where they are told to be.
class Panel : public ::testing::TestWithParam<double> {
 protected:
  static Scene scene(double gravity) {
    SceneOptions options;
    options.default_material = default_material(unfiltered(ContactModelKind::implicit));
    options.gravity = Vector3(0, 0, -gravity);
    return load_scene("config/scenes/panel.urdf", options);
  }

  Simulation simulation_{scene(GetParam()), unfiltered(ContactModelKind::implicit)};
  int limits_ = 0, clicks_ = 0, opened_ = 0;

  void run(double to, const std::function<Hand(double)>& hand) {
    play(simulation_, time_, to, 120.0, hand, [&](const Simulation& now) {
      for (const Event& event : now.result().events) {
        limits_ += event.kind == EventKind::joint_limit;
        clicks_ += event.kind == EventKind::detent;
        opened_ += event.kind == EventKind::latch_open;
      }
      for (std::size_t i = 0; i < now.scene().joints.size(); ++i) {
        ASSERT_LT(apart(now, i).place, 1e-12);
        ASSERT_LT(apart(now, i).turn, 1e-12);
      }
    });
    time_ = to + 1.0 / 120.0;
  }
  double position(const char* joint) const {
    return simulation_.state()
        .joints[static_cast<std::size_t>(*find_joint(simulation_.scene(), joint))]
        .position;
  }
  static Hand touch(const Vector3& from, const Vector3& to) { return finger(from, to, kRadius); }
  /// Two fingertips along `along`, on both sides of a place in the direction `across`.
  static Hand pinch(const Vector3& place, const Vector3& along, const Vector3& across,
                    const Quaternion& turn = Quaternion::Identity()) {
    Hand hand = finger(place + across - along, place + across + along, kRadius);
    add_finger(hand, capsule_index(0, 3), place - across - along, place - across + along, kRadius);
    hand.palm = {place, turn};
    return hand;
  }

 private:
  double time_ = 0.0;
};

TEST_P(Panel, keeps_still_until_a_hand_comes) {
  run(3.0, [](double) { return Hand(); });
  for (std::size_t b = 0; b < simulation_.scene().bodies.size(); ++b) {
    const Body& body = simulation_.scene().bodies[b];
    EXPECT_LT((simulation_.state().bodies[b].pose.position - body.start.position).norm(), 1e-3) << body.name;
    EXPECT_LT(object_twist(simulation_, b).linear.norm(), 1e-9) << body.name;
  }
  EXPECT_EQ(limits_ + clicks_ + opened_, 0);
}

TEST_P(Panel, its_button_goes_in_and_comes_back) {
  double deepest = 0.0;
  run(3.0, [&](double t) {
    deepest = std::max(deepest, position("button_slide"));
    const double tip = 0.10 + 0.022 * (smooth(t, 1.0) - smooth(t - 1.5, 1.0));
    return touch({-0.2, tip - 0.03, 0.36}, {-0.2, tip, 0.36});
  });
  EXPECT_NEAR(deepest, 0.006, 1e-5);
  EXPECT_NEAR(position("button_slide"), 0.0, 1e-5);
  EXPECT_GE(limits_, 2);  // its end, and back
}

TEST_P(Panel, its_switch_flips_with_one_click_and_stays) {
  run(3.0, [](double t) {
    const double height = 0.40 - 0.034 * (smooth(t, 1.0) - smooth(t - 1.2, 1.0));
    return touch({-0.12, 0.122, height}, {-0.10, 0.122, height});
  });
  EXPECT_EQ(clicks_, 1);
  // Gravity pulls at its end: m g l over the detents' stiffness is 0.026.
  EXPECT_NEAR(position("switch_hinge"), 0.35, 0.03);
}

TEST_P(Panel, its_valve_turns_and_stays_where_it_is_left) {
  run(2.5, [](double t) {
    const double height = 0.37 - 0.04 * (smooth(t, 1.0) - smooth(t - 1.2, 1.0));
    return touch({0.05, 0.08, height}, {0.05, 0.12, height});
  });
  const double left = position("valve_axle");
  EXPECT_GT(left, 0.2);
  run(20.0, [](double) { return Hand(); });
  EXPECT_NEAR(position("valve_axle"), left, 1e-9);
}

TEST_P(Panel, its_drawer_follows_the_fingers_out_and_in) {
  double worst = 0.0, out = 0.0;
  run(5.0, [&](double t) {
    if (t > 1.0 && t < 4.2) worst = std::max(worst, std::abs(position("drawer_slide") - out));
    const double grip = 0.017 - 0.006 * (smooth(t, 0.4) - smooth(t - 4.3, 0.4));
    out = 0.12 * (smooth(t - 0.5, 1.5) - smooth(t - 2.5, 1.5));
    return pinch({-0.13, 0.10 - out, 0.15}, {0.015, 0, 0}, {0, 0, grip});
  });
  EXPECT_LT(worst, 0.006);  // a frame's way, and what fingertips give
  EXPECT_EQ(opened_, 1);
  EXPECT_NEAR(position("drawer_slide"), 0.0, 0.003);
}

TEST_P(Panel, its_door_follows_the_fingers_on_its_handle) {
  double worst = 0.0, angle = 0.0;
  const Vector3 hinge(0.2, 0.14, 0.17), handle(0.075, 0.10, 0.17);
  run(3.5, [&](double t) {
    if (t > 0.6) worst = std::max(worst, std::abs(position("door_hinge") - angle));
    const double grip = 0.017 - 0.006 * smooth(t, 0.4);
    angle = 1.2 * smooth(t - 0.5, 2.0);
    const Quaternion turn(Eigen::AngleAxisd(angle, Vector3::UnitZ()));
    return pinch(hinge + turn * (handle - hinge), {0, 0, 0.015}, turn * Vector3(grip, 0, 0), turn);
  });
  EXPECT_LT(worst, 0.05);
  EXPECT_EQ(opened_, 1);
  EXPECT_NEAR(position("door_hinge"), 1.2, 0.03);
}

INSTANTIATE_TEST_SUITE_P(InSpaceAndOnEarth, Panel, ::testing::Values(0.0, 9.81));

}  // namespace
}  // namespace mrhi
