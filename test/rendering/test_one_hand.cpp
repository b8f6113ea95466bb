#include "rendering/expect_one_hand.h"
#include "support/count_allocations.h"
#include "support/pinch_scene.h"
#include "support/posed_hand.h"

namespace mrhi {
namespace {

using testing::at;
using testing::RenderedCheck;

constexpr double kRate = 120.0;  // [1/s]

Body wall(const Vector3& half, const Vector3& centre) {
  return testing::placed_body("wall", Box{half}, {centre, Quaternion::Identity()}, true);
}

/// A flat hand at the origin, fingers along x and palm down, moved by `way(t)`.
class MovingFlatHand {
 public:
  MovingFlatHand(Scene scene, std::function<Vector3(double)> way)
      : simulation_(std::move(scene), testing::unfiltered()),
        check_(simulation_.scene()),
        way_(std::move(way)) {}

  void play(double until, const std::function<void(const Hand& tracked, const Hand& shown)>& each = nullptr) {
    for (; frame_ / kRate <= until; ++frame_) {
      const double t = frame_ / kRate;
      simulation_.advance({at(t), {testing::posed_hand(flat_posture(), {way_(t), Quaternion::Identity()})}});
      check_.see(simulation_);
      if (each) each(simulation_.result().tracked.at(0), simulation_.result().rendered.at(0).hand);
    }
  }
  Simulation& simulation() { return simulation_; }
  const RenderedCheck& check() const { return check_; }
  const HandOffset& offset() const { return simulation_.state().offsets.at(0); }

 private:
  Simulation simulation_;
  RenderedCheck check_;
  std::function<Vector3(double)> way_;
  int frame_ = 0;
};

bool same_bits(const Hand& a, const Hand& b) {
  bool same = a.palm.position == b.palm.position && a.wrist == b.wrist;
  for (std::size_t c = 0; c < kCapsules; ++c) {
    same = same && a.capsules[c].start == b.capsules[c].start && a.capsules[c].end == b.capsules[c].end &&
           a.capsules[c].radius == b.capsules[c].radius;
  }
  return same;
}

/// Down by `depth` and up again, half a second each way.
std::function<Vector3(double)> down_and_up(double depth) {
  return [depth](double t) -> Vector3 {
    return Vector3(0, 0, 0.02 - depth * (testing::smooth(t, 0.5) - testing::smooth(t - 0.6, 0.5)));
  };
}

TEST(OneHand, is_the_tracked_hand_to_the_bit_where_nothing_touches) {
  MovingFlatHand hand(testing::scene_of(wall(Vector3(0.2, 0.2, 0.01), Vector3(0.1, 0, -0.08))),
                      down_and_up(0.01));
  hand.play(1.2, [](const Hand& tracked, const Hand& shown) { EXPECT_TRUE(same_bits(tracked, shown)); });
}

// The plate is thinner than what the finger is pressed in: the nearest way out leads through it.
TEST(OneHand, a_fingertip_pressed_through_a_thin_plate_stays_on_its_own_side) {
  const Hand still = testing::posed_hand(flat_posture(), Pose());
  const double x = tip_of(still, 2).x();
  MovingFlatHand hand(testing::scene_of(wall(Vector3(0.03, 0.2, 0.0025), Vector3(x + 0.005, 0, -0.03))),
                      down_and_up(0.045));
  double least = 1.0, shifted = 0.0;
  hand.play(1.2, [&](const Hand& tracked, const Hand& shown) {
    least = std::min(least, tip_of(shown, 2).z());
    shifted = std::max(shifted, (shown.palm.position - tracked.palm.position).norm());
  });
  EXPECT_GT(least, -0.0275);
  EXPECT_LT(shifted, 0.015);  // the fingers give way, the hand hardly
  testing::expect_one_hand(hand.check(), "plate");
}

// No joint can bring a palm out of a wall: the whole hand stays in front of it.
TEST(OneHand, a_hand_pushed_into_a_wall_stays_in_front_of_it_as_a_whole) {
  MovingFlatHand hand(testing::scene_of(wall(Vector3(0.3, 0.3, 0.05), Vector3(0.0, 0, -0.08))),
                      down_and_up(0.06));
  double farthest = 0.0, least = 1.0;
  hand.play(1.2, [&](const Hand& tracked, const Hand& shown) {
    farthest = std::max(farthest, (shown.palm.position - tracked.palm.position).norm());
    for (const Capsule& capsule : shown.capsules) {
      if (capsule.radius > 0.0)
        least = std::min(least, std::min(capsule.start.z(), capsule.end.z()) - capsule.radius);
    }
  });
  EXPECT_GT(farthest, 0.02);
  EXPECT_GT(least, -0.0302);
  testing::expect_one_hand(hand.check(), "wall");
}

// A tracker's frame of 8 ms at 2 m/s: what is shown stays at the surface, though the offset jumps.
TEST(OneHand, a_hand_that_hits_a_wall_fast_is_stopped_by_it) {
  MovingFlatHand hand(testing::scene_of(wall(Vector3(0.3, 0.3, 0.05), Vector3(0.0, 0, -0.15))),
                      [](double t) { return Vector3(0, 0, -std::min(2.0 * t, 0.13)); });
  hand.play(0.5);
  EXPECT_GT(hand.offset().shift.norm(), 0.02);
  testing::expect_one_hand(hand.check(), "fast");
}

// The way out of each slab leads into another one.
TEST(OneHand, a_hand_that_appears_in_several_bodies_is_outside_at_once) {
  Scene scene = testing::scene_of(wall(Vector3(0.02, 0.2, 0.2), Vector3(0.05, 0, 0)));
  scene.bodies.push_back(wall(Vector3(0.2, 0.02, 0.2), Vector3(0.05, 0, 0)));
  scene.bodies.push_back(wall(Vector3(0.2, 0.2, 0.02), Vector3(0.05, 0, 0)));
  MovingFlatHand hand(scene, [](double) { return Vector3::Zero(); });
  hand.play(0.1);
  EXPECT_GT(hand.offset().shift.norm(), 0.02);
  EXPECT_LE(hand.check().depth.value, 0.0002);
}

TEST(OneHand, returns_without_a_snap_or_going_ahead_once_the_object_is_gone) {
  Scene scene = testing::scene_of(testing::placed_body(
      "block", Box{Vector3(0.3, 0.3, 0.05)}, {Vector3(0, 0, -0.08), Quaternion::Identity()}, false));
  scene.bounds = {Vector3::Constant(-10.0), Vector3::Constant(10.0)};
  scene.bodies[0].mass = 1e4;
  complete(scene.bodies[0]);
  MovingFlatHand hand(scene, [](double t) { return Vector3(0, 0, 0.02 - 0.04 * testing::smooth(t, 0.5)); });
  hand.play(0.7);
  ASSERT_FALSE(hand.offset().zero());
  SimulationState state = hand.simulation().state();
  state.bodies[0].pose.position.z() -= 1.0;
  hand.simulation().set_state(state);
  double before =
      farthest_joint(hand.simulation().result().tracked[0], hand.simulation().result().rendered[0].hand);
  const double begun = before;
  hand.play(2.0, [&](const Hand& tracked, const Hand& shown) {
    const double now = farthest_joint(tracked, shown);
    EXPECT_LE(now, before);
    EXPECT_LE(before - now, 0.002);
    before = now;
  });
  EXPECT_GT(begun, 0.003);
  EXPECT_TRUE(hand.offset().zero());
  EXPECT_TRUE(same_bits(hand.simulation().result().tracked[0], hand.simulation().result().rendered[0].hand));
}

TEST(OneHand, its_offset_is_part_of_the_state) {
  const Scene scene = testing::scene_of(wall(Vector3(0.3, 0.3, 0.05), Vector3(0.0, 0, -0.08)));
  MovingFlatHand first(scene, down_and_up(0.06)), second(scene, down_and_up(0.06));
  first.play(0.6);
  second.play(0.6);
  SimulationState state = first.simulation().state();
  EXPECT_EQ(hash(state), hash(second.simulation().state()));
  state.offsets[0].shift.z() += 1e-9;
  EXPECT_NE(hash(state), hash(first.simulation().state()));
  Simulation copy(scene, testing::unfiltered());
  copy.set_state(first.simulation().state());
  const double t = 0.6 + 2.0 / kRate;
  const Hand next = testing::posed_hand(flat_posture(), {down_and_up(0.06)(t), Quaternion::Identity()});
  first.simulation().advance({at(t), {next}});
  copy.advance({at(t), {next}});
  EXPECT_TRUE(same_bits(first.simulation().result().rendered[0].hand, copy.result().rendered[0].hand));
}

// Counted from the second press on: the first fills what is kept.
TEST(OneHand, showing_it_allocates_nothing_once_warm) {
  const auto way = [](double t) -> Vector3 { return Vector3(0, 0, 0.02 - 0.03 * std::sin(2.0 * M_PI * t)); };
  MovingFlatHand hand(testing::scene_of(wall(Vector3(0.3, 0.3, 0.05), Vector3(0.0, 0, -0.08))), way);
  hand.play(1.2);
  long counted = 0;
  for (int frame = 150; frame < 300; ++frame) {
    const double t = frame / kRate;
    hand.simulation().begin({at(t), {testing::posed_hand(flat_posture(), {way(t), Quaternion::Identity()})}});
    while (hand.simulation().step()) {
    }
    const long before = testing::allocations;
    hand.simulation().end();
    counted += testing::allocations - before;
  }
  EXPECT_EQ(counted, 0);
}

}  // namespace
}  // namespace mrhi
