#include <gtest/gtest.h>

#include "mr_hand_interaction/live_simulation.h"
#include "support/fixtures.h"
#include "support/in_the_way.h"
#include "support/posed_hand.h"

namespace mrhi {
namespace {

using testing::at;

constexpr double kRate = 120.0;            // [1/s]
const Vector3 kInTheHand(0.09, 0.0, 0.0);  // about the palm of a flat hand at the origin
const Vector3 kAway(0.0, 0.0, 1.0);

Body ball() {
  Body ball = testing::ball_body(0.03, 0.05);
  ball.start.position = kInTheHand;
  return ball;
}

/// A ball that starts in a flat hand and, when the hand comes, is far away.
class Appearing {
 public:
  Appearing() : live_(testing::scene_of(ball()), testing::unfiltered(ContactModelKind::implicit)) {
    live_.simulation().advance({at(0.0), {}});
    live_.place("object", {kAway, Quaternion::Identity()});
    play(0.5, Vector3::Zero());
  }

  /// Moves the hand evenly to `offset`; keeps how far it was shown to move beyond what was tracked.
  void play(double seconds, const Vector3& offset) {
    const int frames = static_cast<int>(std::lround(seconds * kRate));
    const Vector3 from = offset_;
    for (int i = 1; i <= frames; ++i) {
      offset_ = from + (offset - from) * i / frames;
      live_.simulation().advance({at(++frame_ / kRate), {hand()}});
      const FrameResult& result = live_.simulation().result();
      jump = std::max(jump, farthest_joint(shown_, result.rendered[0].hand) -
                                farthest_joint(tracked_, result.tracked[0]));
      aside = std::max(aside, farthest_joint(result.tracked[0], result.rendered[0].hand));
      tracked_ = result.tracked[0], shown_ = result.rendered[0].hand;
      for (const Event& event : result.events) kinds.push_back(event.kind);
      touched += static_cast<int>(result.contacts.size());
    }
  }

  Hand hand() const { return testing::posed_hand(flat_posture(), {offset_, Quaternion::Identity()}); }
  LiveSimulation& live() { return live_; }
  const BodyState& object() const { return live_.simulation().state().bodies.at(0); }
  double depth() const { return live_.simulation().deepest_rendered(); }

  double jump = 0.0;
  double aside = 0.0;  // from where it is tracked [m]
  int touched = 0;
  std::vector<EventKind> kinds;

 private:
  LiveSimulation live_;
  Vector3 offset_ = Vector3::Zero();
  Hand tracked_, shown_;  // in the frame before
  long frame_ = 0;
};

struct Way {
  const char* name;
  void (*appear)(Appearing&);
};
std::ostream& operator<<(std::ostream& out, const Way& way) {
  return out << way.name;
}

void put_back(Appearing& scene) {
  SimulationState state = scene.live().simulation().state();
  state.bodies[0].pose.position = Vector3(0, 0, 2.0);
  state.bodies[0].linear_momentum = Vector3(0, 0, 1.0);
  scene.live().simulation().set_state(state);
}
void put_back_in_a_step_near_the_hand(Appearing& scene) {
  put_back(scene);
  SimulationState state = scene.live().simulation().state();
  state.bodies[0].pose.position = Vector3(0, 0, scene.live().simulation().scene().bounds.max.z());
  scene.live().simulation().set_state(state);
}
void place(Appearing& scene) {
  scene.live().place("object", {kInTheHand, Quaternion::Identity()});
}
void spawn(Appearing& scene) {
  scene.live().remove("object");
  scene.live().add(ball());
}
void reset(Appearing& scene) {
  scene.live().reset();
}

const Way kWays[] = {{"put_back", put_back},
                     {"put_back_in_a_step_near_the_hand", put_back_in_a_step_near_the_hand},
                     {"place", place},
                     {"spawn", spawn},
                     {"reset", reset}};

class Appears : public ::testing::TestWithParam<Way> {};

TEST_P(Appears, in_a_hand_without_a_push_or_a_leap_and_is_touched_once_they_have_separated) {
  Appearing scene;
  GetParam().appear(scene);
  scene.play(1.0, Vector3::Zero());
  EXPECT_EQ(scene.object().pose.position, kInTheHand);
  EXPECT_EQ(scene.object().linear_momentum, Vector3::Zero());
  EXPECT_EQ(scene.aside, 0.0);
  scene.play(0.5, Vector3(0, 0, 0.1));
  EXPECT_EQ(scene.object().linear_momentum, Vector3::Zero());
  EXPECT_EQ(scene.touched, 0);
  EXPECT_LE(scene.depth(), 0.0002);
  EXPECT_LE(scene.jump, 0.002);
  scene.play(0.2, Vector3(0, 0, 0.03));
  EXPECT_LT(scene.object().linear_momentum.z(), 0.0);
  EXPECT_GT(scene.touched, 0);
  EXPECT_LE(scene.depth(), 0.0002);
}

INSTANTIATE_TEST_SUITE_P(Way, Appears, ::testing::ValuesIn(kWays),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST(Appears, out_of_bounds_and_back_is_told) {
  Appearing scene;
  put_back(scene);
  scene.play(0.1, Vector3::Zero());
  EXPECT_EQ(std::count(scene.kinds.begin(), scene.kinds.end(), EventKind::out_of_bounds), 1);
}

// A fixture cannot be pushed, but the hand would leap.
TEST(Appears, a_fixture_in_a_hand_does_not_push_it_aside_either) {
  Appearing scene;
  Body wall = testing::placed_body("wall", Box{{0.02, 0.2, 0.2}}, {kInTheHand, Quaternion::Identity()}, true);
  scene.live().add(wall);
  scene.play(0.2, Vector3::Zero());
  EXPECT_LE(scene.jump, 0.002);
  scene.play(0.5, Vector3(0.3, 0, 0));
  EXPECT_LE(scene.jump, 0.002);
  scene.play(0.5, Vector3(0.0, 0, 0));
  EXPECT_LE(scene.depth(), 0.0002);
}

/// Two cubes of 40 mm, one put in the other or in a fixture.
double fastest_apart(bool fixture, const Vector3& gravity) {
  Scene scene;
  scene.gravity = gravity;
  for (const char* name : {"first", "second"}) {
    scene.bodies.push_back(testing::box_body(Vector3::Constant(0.04), 0.05));
    scene.bodies.back().name = name;
  }
  scene.bodies[0].fixed = fixture;
  scene.bodies[1].start.position = kAway;
  LiveSimulation live(scene, testing::unfiltered(ContactModelKind::implicit));
  live.simulation().advance({at(0.0), {}});
  live.place("second", {{0.004, 0.002, 0.01}, Quaternion::Identity()});
  double fastest = 0.0;
  for (int i = 1; i <= 240; ++i) {
    live.simulation().advance({at(i / kRate), {}});
    for (std::size_t b = 0; b < 2; ++b) {
      const Twist twist = testing::object_twist(live.simulation(), b);
      fastest = std::max(fastest, twist.linear.norm() + 0.035 * twist.angular.norm());
    }
  }
  return fastest;
}

// Springs push surfaces apart no faster than this, however deep.
TEST(Appears, in_another_body_and_is_pushed_out_slowly) {
  constexpr double kParting = 0.1;  // [m/s]
  for (const bool fixture : {false, true}) {
    const double fastest = fastest_apart(fixture, Vector3::Zero());
    EXPECT_GT(fastest, 0.0) << fixture;
    EXPECT_LE(fastest, kParting + 1e-9) << fixture;
  }
}

}  // namespace
}  // namespace mrhi
