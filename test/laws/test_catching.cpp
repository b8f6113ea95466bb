#include <gtest/gtest.h>

#include <ostream>

#include "mr_hand_interaction/response/contact_model.h"
#include "support/grips.h"

namespace mrhi {
namespace {

constexpr double kRate = 115.0;     // a Leap's frames [1/s]
constexpr double kLength = 0.12;    // of the bar, along z [m]
constexpr double kApart = 0.012;    // of fingers and bar, on each side, as the hand is open [m]
constexpr double kOverlap = 0.004;  // on each side, as it is closed [m]

/// A bar that moves through a hand along -z while thumb and three fingers close on it along x; or a ball,
/// which moves towards thumb or fingers too.
struct Catch {
  double thickness, drift, closing, gravity;  // [m], [m/s], [s], [m/s^2]
  bool is_ball = false;
  double aside = 0.0;  // part of the drift along x
  double rate = kRate;

  friend std::ostream& operator<<(std::ostream& out, const Catch& c) {
    return out << 1e3 * c.thickness << " mm at " << c.drift << " m/s, closing in " << c.closing << " s, "
               << c.gravity << " m/s^2";
  }
};

struct Outcome {
  bool held = false;
  double slide = 0.0;  // along the fingers, since the grasp began [m]
};

Hand hand_at(double t, const Catch& c) {
  const double gap = kApart - (kApart + kOverlap) * testing::smooth(t - 0.02, c.closing);
  const Vector3 side = (0.5 * c.thickness + gap) * Vector3::UnitX();
  Hand hand = testing::empty_hand();
  hand.palm.position = Vector3(0.02, 0.16, 0.0);
  testing::add_flat_finger(hand, capsule_index(0, 3), -side, -Vector3::UnitX(), Vector3::UnitY());
  for (int finger = 1; finger <= 3; ++finger)
    testing::add_flat_finger(hand, capsule_index(finger, 3), side + Vector3(0, 0, 0.02 * (finger - 2)),
                             Vector3::UnitX(), Vector3::UnitY());
  return hand;
}

/// With the shipped hand and filter.
Outcome outcome_of(const Catch& c, bool assist) {
  Configuration configuration;
  configuration.contact.grasp_assist = assist;
  Body bar = c.is_ball ? testing::ball_body(0.5 * c.thickness, 0.1)
                       : testing::box_body(Vector3(c.thickness, c.thickness, kLength), 0.05);
  bar.material = default_material(configuration);
  const double height = 0.03 + c.drift * 0.05;
  const Vector3 drift = c.drift * Vector3(c.aside, 0.0, -std::sqrt(1.0 - c.aside * c.aside));
  bar.start.position = c.is_ball ? Vector3(-drift * (0.02 + 0.75 * c.closing)) : Vector3(0.0, 0.0, height);
  Scene scene = testing::scene_of(bar);
  scene.gravity.z() = -c.gravity;
  scene.bounds = {Vector3::Constant(-10.0), Vector3::Constant(10.0)};
  Simulation simulation(scene, configuration);
  SimulationState state = simulation.state();
  state.bodies[0].linear_momentum = bar.mass * drift;
  simulation.set_state(state);
  std::optional<double> began;
  testing::play(
      simulation, 0.0, 1.5, c.rate, [&](double t) { return hand_at(t, c); },
      [&](const Simulation& s) {
        const double z = s.state().bodies[0].pose.position.z();
        if (!began && testing::has_event(s, EventKind::grasp_begin)) began = z;
      });
  const double z = simulation.state().bodies[0].pose.position.z();
  const bool rests = testing::object_twist(simulation).linear.norm() < 0.02;
  return {is_held(0, simulation.state()) && rests, began ? std::abs(z - *began) : 0.0};
}

// Where contact alone holds, grasp assist changes nothing that one could see: 0.5 mm.
TEST(Catching, assist_is_never_worse_than_contact_alone) {
  int held = 0, held_alone = 0, cells = 0;
  for (const double thickness : {0.005, 0.01, 0.016, 0.025, 0.04, 0.06}) {
    for (const double drift : {0.0, 0.1, 0.3, 0.5, 0.8, 1.0}) {
      for (const double closing : {0.05, 0.1, 0.2, 0.4}) {
        for (const double gravity : {0.0, 9.81}) {
          const Catch c{thickness, drift, closing, gravity};
          const Outcome with = outcome_of(c, true), alone = outcome_of(c, false);
          ++cells, held += with.held, held_alone += alone.held;
          if (!alone.held) continue;
          EXPECT_TRUE(with.held) << c;
          EXPECT_LE(with.slide, std::max(0.002, alone.slide + 0.0005)) << c;
        }
      }
    }
  }
  RecordProperty("held", held);
  std::cout << "of " << cells << " held " << held << ", by contact alone " << held_alone << "\n";
  EXPECT_GE(held, held_alone);
}

// A ball is pressed out between fingers that meet it off its middle, with assist or without.
TEST(Catching, assist_loses_at_most_4_of_162_balls_that_contact_alone_holds) {
  int lost = 0, saved = 0, cells = 0;
  for (const double thickness : {0.03, 0.04, 0.06}) {
    for (const double drift : {0.6, 0.8, 1.0}) {
      for (const double closing : {0.1, 0.2, 0.3}) {
        for (const double aside : {-0.3, 0.0, 0.3}) {
          for (const double rate : {60.0, 120.0}) {
            const Catch c{thickness, drift, closing, 0.0, true, aside, rate};
            const Outcome with = outcome_of(c, true), alone = outcome_of(c, false);
            ++cells, lost += alone.held && !with.held, saved += with.held && !alone.held;
          }
        }
      }
    }
  }
  std::cout << "of " << cells << " balls lost by assist " << lost << ", saved " << saved << "\n";
  EXPECT_LE(lost, 4);
}

}  // namespace
}  // namespace mrhi
