#include "support/bar_by_its_end.h"
#include "support/deep_squeeze.h"
#include "support/edge_pinch.h"
#include "support/noisy_pinch.h"
#include "support/one_side_leaves.h"
#include "support/pinch_ride.h"
#include "support/slap.h"
#include "variant.h"

namespace mrhi::ablation {
namespace {

using testing::at;
using testing::kDegrees;

constexpr double kFine = 0.001, kOnePerFrame = 1.0 / 119.0;  // steps [s]
constexpr double kGravity = 9.81;                            // [m/s^2]

Configuration stepped(const Variant& variant, double step) {
  Configuration configuration = variant.configuration;
  configuration.step = step;
  return configuration;
}

testing::Ride shaken(const Variant& variant, double step) {
  const double rate = step == kFine ? 1000.0 : 120.0;
  return testing::ride(variant.pinch, stepped(variant, step), rate, testing::eased(0.05, 3.0));
}

/// Speed of the cube in a still hand that grips it twice as hard as its weight needs [m/s]. Gravity acts on
/// it once it is gripped.
double creep(const Variant& variant) {
  constexpr double kGripped = 1.0, kSettled = 5.0, kWatched = 20.0, kRate = 60.0;
  testing::PinchScene pinch = variant.pinch;
  // Four springs oppose one.
  pinch.overlap = 0.25 * (2.0 * pinch.mass * kGravity / Material().static_friction) / (0.8 * pinch.stiffness);
  Configuration configuration = variant.configuration;
  configuration.gravity = Vector3(0, 0, -kGravity);
  const auto play = [&](Simulation& simulation, double from, double to) {
    testing::play(simulation, from, to, kRate, [&](double t) { return pinch.hand(t, Vector3::Zero()); });
    return simulation.state().bodies[0].pose.position;
  };
  Simulation weightless(pinch.scene(), variant.configuration), simulation(pinch.scene(), configuration);
  play(weightless, 0.0, kGripped);
  simulation.set_state(weightless.state());
  const Vector3 settled = play(simulation, kGripped + 1.0 / kRate, kSettled);
  return (play(simulation, kSettled + 1.0 / kRate, kSettled + kWatched) - settled).norm() / kWatched;
}

/// Time until a held cube kicked to 0.1 m/s stays slower than 1 mm/s [s].
double time_to_rest(const Variant& variant) {
  constexpr double kRate = 1000.0, kKicked = 1.0, kWatched = 4.0;
  Simulation simulation(variant.pinch.scene(), stepped(variant, kFine));
  const auto hand = [&](double t) { return variant.pinch.hand(t, Vector3::Zero()); };
  testing::play(simulation, 0.0, kKicked, kRate, hand);
  SimulationState state = simulation.state();
  state.bodies[0].linear_momentum += 0.1 * variant.pinch.mass * Vector3::Ones().normalized();
  simulation.set_state(state);
  double rest = 0.0, t = 0.0;
  testing::play(simulation, kKicked + 1.0 / kRate, kKicked + kWatched, kRate, hand, [&](const Simulation& s) {
    t += 1.0 / kRate;
    if (testing::object_twist(s).linear.norm() > 0.001) rest = t;
  });
  return rest;
}

testing::NoisyRide in_raw_noise(const Variant& variant) {
  return testing::noisy_ride(testing::NoisyPinch(1, variant.pinch), variant.configuration);
}

/// rms of the thumb's force under raw tracking noise [N].
double force_noise(const Variant& variant) {
  testing::NoisyPinch pinch(1, variant.pinch);
  Simulation simulation(pinch.scene(), variant.configuration);
  double count = 0.0, sum = 0.0, squares = 0.0;
  testing::play(
      simulation, 0.0, testing::kNoisyFrom + testing::kNoisyFor - 0.1, testing::kNoisyRate,
      [&](double t) { return pinch.sample(t); },
      [&](const Simulation& s) {
        if (to_seconds(s.result().stamp - testing::kStart) < testing::kNoisyFrom) return;
        double push = 0.0;
        for (const Contact& contact : s.state().contacts) {
          if (finger_of(contact.key.capsule) == 0) push -= contact.normal.dot(contact.force);
        }
        count += 1.0, sum += push, squares += push * push;
      });
  return std::sqrt(squares / count - sum / count * (sum / count));
}

testing::Squeezed squeezed_plate(const Variant& variant) {
  return testing::squeeze_and_carry({"plate", {0.01, 0.1, 0.1}, true}, variant.configuration);
}

double plates(const Variant& variant, double speed, double rate) {
  Configuration configuration = stepped(variant, 0.05);
  configuration.tracking.max_speed = 100.0;
  return testing::plates_hit(speed, rate, configuration);
}

/// Relative error of a slap 2 cm off centre at 3 m/s, from the closed form.
Twist slap_error(const Variant& variant) {
  constexpr double kLever = 0.02;
  const Body body = testing::slab(Vector3::Constant(0.05), 0.5);
  const Twist expected = testing::blow(body, 3.0, 0.5, 0.025, kLever);
  Simulation simulation(testing::scene_of(body), stepped(variant, kFine));
  testing::play(simulation, 0.0, 0.054, 1000.0, testing::hitter(3.0, 0.025, 0.0503, Vector3(0, 0, kLever)));
  const Twist twist = testing::object_twist(simulation);
  return {(twist.linear - expected.linear) / expected.linear.norm(),
          (twist.angular - expected.angular) / expected.angular.norm()};
}

}  // namespace

const std::vector<Measure>& measures() {
  using V = const Variant&;
  static const std::vector<Measure> all{
      {"compliance", "(a): grip force", "N", [](V v) { return 0.5 * shaken(v, kFine).push; }},
      {"compliance", "(a) in raw noise: rms change of the thumb's force", "N", force_noise},
      {"compliance", "(a), shake: displacement", "mm",
       [](V v) { return 1e3 * shaken(v, kFine).displacement; }},
      {"compliance", "(a) in raw noise: true slip", "mm",
       [](V v) { return 1e3 * in_raw_noise(v).true_slip; }},
      {"anchors", "(a) at 1 g: creep", "µm/s", [](V v) { return 1e6 * creep(v); }},
      {"anchors", "(a), shake: true slip", "mm", [](V v) { return 1e3 * shaken(v, kFine).true_slip; }},
      {"anchors", "(a), shake: true turn", "°", [](V v) { return shaken(v, kFine).true_turn / kDegrees; }},
      {"torsion", "bar held by its end: turn about the finger line", "°",
       [](V v) { return testing::swing_about_finger_line(v.configuration).largest / kDegrees; }},
      {"two_points", "(a), shake: true slip", "mm", [](V v) { return 1e3 * shaken(v, kFine).true_slip; }},
      {"two_points", "(a), shake, one step per frame: true slip", "mm",
       [](V v) { return 1e3 * shaken(v, kOnePerFrame).true_slip; }},
      {"two_points", "(a), hand still: movement left per step", "µm",
       [](V v) { return 1e6 * shaken(v, kFine).jitter; }},
      {"damping", "(a), kicked to 0.1 m/s: time to rest", "ms", [](V v) { return 1e3 * time_to_rest(v); }},
      {"damping", "(a) in raw noise: jitter of the cube", "µm",
       [](V v) { return 1e6 * in_raw_noise(v).cube.rms(); }},
      {"damping", "(a) in raw noise: true slip", "mm", [](V v) { return 1e3 * in_raw_noise(v).true_slip; }},
      {"release_fade", "(a), the fingers leave at 2 m/s: speed by the thumb's push", "m/s",
       [](V v) { return testing::speed_as_one_side_leaves(stepped(v, kFine)); }},
      {"edge_grip", "bar pinched by its edges and shaken: off its place", "mm",
       [](V v) { return 1e3 * testing::squeezed_out(v.configuration); }},
      {"entry_face", "plate squeezed 15 mm deep: off its place", "mm",
       [](V v) { return 1e3 * squeezed_plate(v).off; }},
      {"swing_back", "plate squeezed 15 mm deep: turn", "°",
       [](V v) { return squeezed_plate(v).turned / kDegrees; }},
      {"sweep", "plates hit of 25, 3 m/s at 120 Hz", "", [](V v) { return plates(v, 3.0, 120.0); }},
      {"sweep", "plates hit of 25, 10 m/s at 60 Hz", "", [](V v) { return plates(v, 10.0, 60.0); }},
      {"impact_friction", "slap 2 cm off centre: error of v", "%",
       [](V v) { return 1e2 * slap_error(v).linear.norm(); }},
      {"impact_friction", "slap 2 cm off centre: error of ω", "%",
       [](V v) { return 1e2 * slap_error(v).angular.norm(); }},
  };
  return all;
}

}  // namespace mrhi::ablation
