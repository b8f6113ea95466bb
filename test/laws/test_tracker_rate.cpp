#include <gtest/gtest.h>

#include <map>

#include "support/grips.h"
#include "support/pinch_ride.h"
#include "support/tessellated.h"

// Scene (a) as a tracker samples it. Between two frames the hand moves on a path with continuous velocity
// (HandPath): on straight lines a held cube would be struck anew at every frame.

namespace mrhi {
namespace {

using testing::PinchScene;
using testing::smooth;
using testing::swing;

constexpr double kShake = 3.0;             // [Hz]
constexpr double kFrom = 1.0, kFor = 4.0;  // [s]
const Vector3 kDirection = Vector3(1, 2, 2) / 3.0;

Configuration configuration_of(const HandStrength& hand, const FilterKind& filter) {
  Configuration configuration = testing::unfiltered(ContactModelKind::implicit);
  configuration.contact.grasp_assist = false;
  configuration.contact.hand = hand;
  configuration.filter.type = filter;
  return configuration;
}

struct Shaken {
  bool slips = false;                      // any contact, while it is shaken
  double true_slip = 0.0;                  // of the cube in the hand, after against before [m]
  std::vector<double> force_over_inertia;  // by step within a frame: regression of the force on m a
};

Shaken shake(const Configuration& configuration, double rate, double amplitude) {
  const PinchScene pinch;
  Simulation simulation(pinch.scene(), configuration);
  Shaken result;
  Vector3 before = Vector3::Zero();
  std::vector<double> products, squares;
  for (int frame = 0; frame / rate < kFrom + kFor + 0.5; ++frame) {
    const double t = frame / rate, since = t - kFrom;
    const double ease = since < 0.0 ? 0.0 : smooth(since, 1.0) * (1.0 - smooth(since - kFor + 1.0, 1.0));
    simulation.begin({testing::at(t), {pinch.hand(t, ease * swing(since, amplitude, kShake))}});
    std::vector<double> forces;
    while (simulation.step()) {
      double force = 0.0;
      for (const Contact& contact : simulation.state().contacts) {
        force += contact.force.dot(kDirection);
        if (since > 0.0 && contact.touching() && contact.friction != Friction::sticking) result.slips = true;
      }
      forces.push_back(force);
    }
    products.resize(forces.size(), 0.0), squares.resize(forces.size(), 0.0);
    const bool steady = since > 1.3 && since < kFor - 1.2;
    for (std::size_t i = 0; steady && i < forces.size(); ++i) {
      const double middle = since - (1.0 - (static_cast<double>(i) + 0.5) / forces.size()) / rate;
      const double turns = 2.0 * M_PI * kShake;
      const double inertia = -pinch.mass * amplitude * turns * turns * std::sin(turns * middle);
      products[i] += forces[i] * inertia, squares[i] += inertia * inertia;
    }
    simulation.end();
    if (since < 0.0) before = simulation.state().bodies[0].pose.position;
  }
  result.true_slip = (simulation.state().bodies[0].pose.position - before).norm();
  for (std::size_t i = 0; i < products.size(); ++i)
    result.force_over_inertia.push_back(products[i] / squares[i]);
  return result;
}

/// The largest amplitude at which no contact slips, by halving, to 2e-5 of the range [m].
double largest_without_slip(const Configuration& configuration, double rate) {
  double holds = 0.001, slips = 0.4;
  for (int i = 0; i < 12; ++i) {
    const double middle = 0.5 * (holds + slips);
    (shake(configuration, rate, middle).slips ? slips : holds) = middle;
  }
  return holds;
}

struct SampledHand {
  const char* name;
  HandStrength strength;
};
class AtATrackersRate : public ::testing::TestWithParam<SampledHand> {};

TEST_P(AtATrackersRate, a_shaken_cube_slips_no_sooner_than_in_a_hand_sampled_at_1_kHz) {
  Configuration configuration = configuration_of(GetParam().strength, FilterKind::none);
  const double reference = largest_without_slip(configuration, 1000.0);
  for (const double rate : {60.0, 90.0, 120.0, 240.0})
    EXPECT_GE(largest_without_slip(configuration, rate), 0.9 * reference) << rate << " Hz";
  // Measured: 0.60 and 0.65; ten frames a period do not tell the acceleration within one better.
  EXPECT_GE(largest_without_slip(configuration, 30.0), 0.55 * reference) << "30 Hz";
  for (const double step : {0.00025, 0.004, 0.00834}) {
    configuration.step = step;
    EXPECT_GE(largest_without_slip(configuration, 120.0), 0.9 * reference) << step << " s";
  }
}

INSTANTIATE_TEST_SUITE_P(hands, AtATrackersRate,
                         ::testing::Values(SampledHand{"the_papers", HandStrength{}},
                                           SampledHand{"a_persons", HandStrength::of_a_person()}),
                         [](const auto& of) { return of.param.name; });

/// 0.6 % as measured: what the extrapolated velocity is off at 3 Hz.
TEST(TrackerRate, in_every_step_of_a_120_Hz_frame_the_contacts_give_what_the_cubes_inertia_takes) {
  const Shaken shaken = shake(configuration_of(HandStrength{}, FilterKind::none), 120.0, 0.01);
  ASSERT_EQ(shaken.force_over_inertia.size(), 9u);
  for (const double ratio : shaken.force_over_inertia) EXPECT_NEAR(ratio, 1.0, 0.05);
}

/// What is reported of a frame is the momentum that the hand has given within it over the frame's time: at 0
/// g all that the cube has gained. What Newton's method leaves: 5e-7 N s of 0.1, as measured.
TEST(TrackerRate, the_forces_of_a_frame_are_the_momentum_given_in_it_over_its_time) {
  const PinchScene pinch;
  for (const double rate : {60.0, 120.0, 240.0}) {
    Simulation simulation(pinch.scene(), configuration_of(HandStrength::of_a_person(), FilterKind::none));
    Vector3 before = Vector3::Zero();
    for (int frame = 0; frame / rate < 2.0; ++frame) {
      const double t = frame / rate;
      simulation.advance(
          {testing::at(t), {pinch.hand(t, smooth(t - 0.5, 0.5) * swing(t - 0.5, 0.05, kShake))}});
      Vector3 given = Vector3::Zero();
      for (const Contact& contact : simulation.result().contacts)
        given += contact.force / rate + contact.impulse;
      const Vector3 now = simulation.state().bodies[0].linear_momentum;
      if (frame > 0) {
        EXPECT_LE((given - (now - before)).norm(), 1e-6) << rate << " Hz, " << t << " s";
      }
      before = now;
    }
  }
}

TEST(TrackerRate, a_frames_peak_of_a_phalanx_is_its_largest_force_in_one_of_the_steps) {
  const PinchScene pinch;
  Simulation simulation(pinch.scene(), configuration_of(HandStrength::of_a_person(), FilterKind::none));
  int pressed = 0;
  for (int frame = 0; frame < 120; ++frame) {
    const double t = frame / 60.0;
    simulation.begin({testing::at(t), {pinch.hand(t, smooth(t - 0.5, 0.5) * swing(t - 0.5, 0.05, kShake))}});
    std::map<int, double> largest;  // by phalanx
    while (simulation.step()) {
      std::map<int, Vector3> forces;
      for (const Contact& contact : simulation.state().contacts)
        forces.try_emplace(contact.key.capsule, Vector3::Zero()).first->second += contact.force;
      for (const auto& [phalanx, force] : forces) largest[phalanx] = std::max(largest[phalanx], force.norm());
    }
    std::map<int, double> reported;
    for (const Contact& contact : simulation.end().contacts)
      reported[contact.key.capsule] = std::max(reported[contact.key.capsule], contact.peak_force);
    for (const auto& [phalanx, force] : largest) {
      EXPECT_DOUBLE_EQ(reported[phalanx], force) << t << " s";
      if (force > 0.0) ++pressed;
    }
  }
  EXPECT_GT(pressed, 100);
}

/// How far a cube of 0.1 kg between two fingers is off its place in the hand after it was shaken with `share`
/// of the acceleration that Coulomb's limit of both allows: a = 2 mu N / m.
double off_place(const HandStrength& hand, double normal_force, double rate, double share) {
  const Body cube = testing::stiff_box(Vector3::Constant(0.05), 0.1);
  const double turns = 2.0 * M_PI * kShake;
  const double amplitude =
      share * 2.0 * cube.material.static_friction * normal_force / (cube.mass * turns * turns);
  Scene scene = testing::scene_of(cube);
  scene.bounds = {Vector3::Constant(-100.0), Vector3::Constant(100.0)};  // once lost it is not put back
  Simulation simulation(scene, configuration_of(hand, FilterKind::none));
  Vector3 before = Vector3::Zero();
  for (int frame = 0; frame / rate < kFrom + kFor + 0.5; ++frame) {
    const double t = frame / rate, since = t - kFrom;
    const double ease = since < 0.0 ? 0.0 : smooth(since, 1.0) * (1.0 - smooth(since - kFor + 1.0, 1.0));
    Pose sway;
    sway.position = ease * amplitude * std::sin(turns * since) * Vector3::UnitZ();
    simulation.advance(
        {testing::at(t),
         {testing::moved(testing::symmetric_pinch(0.025, testing::closing_gap(t, 0.002)), sway)}});
    if (since < 0.0) before = simulation.state().bodies[0].pose.position;
  }
  return (simulation.state().bodies[0].pose.position - before).norm();
}

/// Beyond the limit it creeps there and back as long as it is slower than 1 cm/s. At a depth of 2 mm a rigid
/// finger presses with 4 N, a person's pad of 2 mm with half of it.
TEST(TrackerRate, a_cube_between_two_fingers_loses_its_place_only_at_coulombs_limit) {
  for (const double rate : {60.0, 90.0, 120.0}) {
    for (const bool person : {false, true}) {
      const HandStrength hand = person ? HandStrength::of_a_person() : HandStrength{};
      const double force = person ? 2.0 : 4.0;
      EXPECT_LT(off_place(hand, force, rate, 0.97), 1e-6) << rate << " Hz";
      EXPECT_GT(off_place(hand, force, rate, 1.2), 1e-2) << rate << " Hz";
    }
  }
}

/// How far a box of 0.3 kg slides on four straight fingers at 1 g, which tilt within 1 s, to either side [m].
double slid_on_open_hand(double angle, double rate) {
  constexpr double kRadius = 0.008, kHalf = 0.015, kBone = 0.06;
  Hand flat = testing::finger(Vector3(0.0, -0.033, -kRadius), Vector3(kBone, -0.033, -kRadius), kRadius);
  for (int finger = 1; finger < kFingers; ++finger) {
    for (int bone = 1; bone < 4; ++bone) {
      const Vector3 from(kBone * (bone - 2), 0.022 * (finger - 2.5), -kRadius);
      testing::add_finger(flat, capsule_index(finger, bone), from, from + kBone * Vector3::UnitX(), kRadius);
    }
  }
  Configuration configuration = configuration_of(HandStrength::of_a_person(), FilterKind::none);
  configuration.gravity = -9.81 * Vector3::UnitZ();
  Body box = testing::stiff_box(Vector3(0.08, 0.08, 2.0 * kHalf), 0.3);
  box.start.position = Vector3(0.0, 0.0, kHalf);
  Simulation simulation(testing::scene_of(box), configuration);
  Vector3 before = Vector3::Zero(), after = Vector3::Zero();
  for (int frame = 0; frame / rate < 3.0; ++frame) {
    const double t = frame / rate;
    const Quaternion turn(Eigen::AngleAxisd(-angle * smooth(t - 1.0, 1.0), Vector3::UnitX()));
    simulation.advance({testing::at(t), {testing::moved(flat, Pose{Vector3::Zero(), turn})}});
    after = turn.conjugate() * simulation.state().bodies[0].pose.position;
    if (t < 0.9) before = after;
  }
  return (after - before).head<2>().norm();
}

/// Phalanges below a box carry unequal loads: what slips first keeps static friction until the box slides.
/// 1 mm: what the pads shear by, as measured 0.6.
TEST(TrackerRate, a_box_on_an_open_hand_slides_off_only_where_it_is_tilted_beyond_coulombs_limit) {
  const double limit = std::atan(Material().static_friction);
  for (const double rate : {60.0, 120.0}) {
    EXPECT_LT(slid_on_open_hand(0.97 * limit, rate), 1e-3) << rate << " Hz";
    EXPECT_GT(slid_on_open_hand(1.05 * limit, rate), 1e-2) << rate << " Hz";
  }
}

/// How far a wedge of 0.1 kg, whose faces lean by `angle`, is squeezed out by thumb and index finger that
/// close on it from the side in 0.3 s by `press`, at 0 g [m].
double squeezed_out(double angle, double rate, double press) {
  constexpr double kHeight = 0.04, kNarrow = 0.005, kLength = 0.04;  // half the length and the narrow width
  const double wide = kNarrow + kHeight * std::tan(angle);
  const auto corner = [&](int side, int end, bool top) {
    return Vector3(side * (top ? wide : kNarrow), end * kLength, (top ? 0.5 : -0.5) * kHeight);
  };
  testing::MeshMaker maker;
  for (const int side : {-1, 1}) {
    maker.square(corner(side, -side, false), corner(side, side, false), corner(side, side, true),
                 corner(side, -side, true));
    maker.square(corner(-side, side, false), corner(-side, side, true), corner(side, side, true),
                 corner(side, side, false));
  }
  for (const bool top : {false, true})
    maker.square(corner(-1, top ? -1 : 1, top), corner(1, top ? -1 : 1, top), corner(1, top ? 1 : -1, top),
                 corner(-1, top ? 1 : -1, top));
  Body wedge = testing::stiff_box(Vector3::Constant(kHeight), 0.1);
  wedge.shapes.front().shape = Mesh{std::make_shared<const TriangleMesh>(maker.take()), "", Vector3::Ones()};
  Configuration configuration = configuration_of(HandStrength::of_a_person(), FilterConfiguration().type);
  Simulation simulation(testing::scene_of(wedge), configuration);
  const double touch =
      kNarrow + 0.5 * kHeight * std::tan(angle) + testing::kFingertipRadius * (1.0 / std::cos(angle) - 1.0);
  double moved = 0.0;
  testing::play(
      simulation, 0.0, 1.5, rate,
      [&](double t) {
        Hand hand = testing::empty_hand();
        const double gap = touch + 0.003 - (0.003 + press) * smooth(t - 0.1, 0.3);
        testing::add_fingertip(hand, capsule_index(1, 3), gap * Vector3::UnitX(), Vector3::UnitX());
        testing::add_fingertip(hand, capsule_index(0, 3), -gap * Vector3::UnitX(), -Vector3::UnitX());
        return hand;
      },
      [&](const Simulation& s) { moved = std::max(moved, s.state().bodies[0].pose.position.norm()); });
  return moved;
}

/// Coulomb's limit is atan 0.8 = 38.7 degrees. With dynamic friction the limit is 31.
TEST(TrackerRate, a_wedge_stays_between_fingers_that_close_on_it_up_to_static_friction) {
  for (const double rate : {30.0, 60.0, 120.0}) {
    for (const double press : {0.001, 0.004}) {
      EXPECT_LT(squeezed_out(36.0 * M_PI / 180.0, rate, press), 0.003) << rate << " Hz, " << press << " m";
      EXPECT_GT(squeezed_out(41.0 * M_PI / 180.0, rate, press), 0.005) << rate << " Hz, " << press << " m";
    }
  }
}

/// As it ships, but for the grasp assist, which would hide a slip. Shear in a pad is summed up as the load
/// changes, so a cycle of both leaves a little: 1 um a cycle at 60 Hz, where frames cut the swing coarsely.
TEST(TrackerRate, a_cube_shaken_by_5_cm_stays_in_the_shipped_hand) {
  const FilterKind shipped = FilterConfiguration().type;
  for (const double rate : {30.0, 45.0, 60.0, 90.0, 120.0, 240.0})
    EXPECT_LE(shake(configuration_of(HandStrength::of_a_person(), shipped), rate, 0.05).true_slip,
              rate < 90.0 ? 2e-5 : 5e-6)
        << rate << " Hz";
}

}  // namespace
}  // namespace mrhi
