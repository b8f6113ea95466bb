#include <gtest/gtest.h>

#include "support/grips.h"

namespace mrhi {
namespace {

using testing::at;
using testing::closing_gap;
using testing::kDegrees;
using testing::smooth;

constexpr double kTrackerRate = 120.0;  // [1/s]

Configuration under_gravity(double gravity) {
  Configuration configuration = testing::implicit_configuration();
  configuration.gravity = Vector3(0, 0, -gravity);
  return configuration;
}

/// A hand whose four fingers lie flat beside the side of a box that faces `outward`, `gap` away.
Hand flat_hand(std::uint32_t id, Side side, double half, double gap, const Vector3& outward) {
  Hand hand = testing::empty_hand(id, side);
  hand.palm.position = (half + 0.03) * outward;
  for (int finger = 1; finger < kFingers; ++finger) {
    const Vector3 point = (half + gap) * outward + Vector3(0, (finger - 2.5) * 0.02, 0);
    testing::add_flat_finger(hand, capsule_index(finger, 3), point, outward, Vector3::UnitZ());
  }
  return hand;
}

/// Drives a free box with two hands. Gravity is on from the start; `hands_at` must hold the box by `held`
/// [s], until when it is kept at its start.
class Carried {
 public:
  Carried(double half, double mass, double gravity)
      : simulation_(testing::scene_of(testing::stiff_box(Vector3::Constant(2.0 * half), mass)),
                    under_gravity(gravity)) {}

  /// `way` is where the hands carry the box; from `held` on the box may be off it by this much.
  void play(double held, double until, const std::function<Pose(double)>& way,
            const std::function<std::vector<Hand>(double)>& hands_at) {
    double t = 0.0;
    for (int frame = 0; (t = frame / kTrackerRate) < until; ++frame) {
      simulation_.advance({at(t), hands_at(t)});
      if (t < held) {
        SimulationState state = simulation_.state();
        state.bodies[0] = start_state(simulation_.scene().bodies[0]);
        simulation_.set_state(state);
        continue;
      }
      const Pose& pose = simulation_.state().bodies[0].pose;
      off_ = std::max(off_, (pose.position - way(t).position).norm());
      turned_ = std::max(turned_, pose.orientation.angularDistance(way(t).orientation));
    }
  }
  double off() const { return off_; }
  double turned() const { return turned_; }
  const SimulationState& state() const { return simulation_.state(); }

 private:
  Simulation simulation_;
  double off_ = 0.0, turned_ = 0.0;  // [m], [rad]
};

/// Lifted by 20 cm, turned by 60 degrees about the line between the hands and back.
TEST(ImplicitTwoHands, squeeze_a_box_between_them_lift_and_turn_it) {
  constexpr double kHalf = 0.1;
  const auto way = [](double t) {
    Pose pose;
    pose.position = Vector3(0, 0, 0.2 * smooth(t - 1.0, 0.8));
    pose.orientation =
        Eigen::AngleAxisd(60.0 * kDegrees * (smooth(t - 2.0, 0.8) - smooth(t - 3.0, 0.8)), Vector3::UnitX());
    return pose;
  };
  const auto hands = [&](double t) -> std::vector<Hand> {
    const double gap = closing_gap(t, 0.003);
    return {testing::moved(flat_hand(1, Side::right, kHalf, gap, Vector3::UnitX()), way(t)),
            testing::moved(flat_hand(2, Side::left, kHalf, gap, -Vector3::UnitX()), way(t))};
  };
  for (const double gravity : {0.0, 9.81}) {
    Carried box(kHalf, 0.5, gravity);
    box.play(0.5, 4.5, way, hands);
    // 16 kN/m gives way by 0.3 mm to 0.5 kg, and by as much again to the motion.
    EXPECT_LE(box.off(), 0.001) << gravity;
    EXPECT_LE(box.turned(), 1.0 * kDegrees) << gravity;
  }
}

/// The right hand pinches along x and brings the cube; the left pinches it along y at 1.5 s, the right opens
/// at 2 s and goes away, the left carries it on.
TEST(ImplicitTwoHands, hand_a_cube_over) {
  constexpr double kHalf = 0.025;
  const auto way = [](double t) {
    Pose pose;
    pose.position = Vector3(0.1 * smooth(t - 0.6, 0.8), 0.0, 0.1 * smooth(t - 2.6, 0.8));
    return pose;
  };
  const auto opening = [](double t, double from) { return 0.05 * smooth(t - from, 0.4); };
  const auto hands = [&](double t) -> std::vector<Hand> {
    Pose right = way(std::min(t, 2.0)), left = way(t);
    left.orientation = Quaternion(Eigen::AngleAxisd(0.5 * M_PI, Vector3::UnitZ()));
    Hand giver = testing::symmetric_pinch(kHalf, closing_gap(t, 0.002) + opening(t, 2.0));
    Hand taker = testing::symmetric_pinch(kHalf, closing_gap(t - 1.5, 0.002));
    giver.palm.position += Vector3(0.1, 0, 0);
    taker.id = 2;
    taker.side = Side::left;
    return {testing::moved(giver, right), testing::moved(taker, left)};
  };
  for (const double gravity : {0.0, 9.81}) {
    Carried cube(kHalf, 0.1, gravity);
    cube.play(0.5, 4.5, way, hands);
    // 4 kN/m gives way by 0.25 mm to the weight, taken up once more by the second hand.
    EXPECT_LE(cube.off(), 0.001) << gravity;
    EXPECT_LE(cube.turned(), 1.0 * kDegrees) << gravity;
    EXPECT_EQ(cube.state().interactions[0].level, InteractionLevel::none);
    EXPECT_EQ(cube.state().interactions[1].level, InteractionLevel::grasp);
  }
}

}  // namespace
}  // namespace mrhi
