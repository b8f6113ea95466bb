// Speed that a hand at 0.3 m/s gives to a cube at rest, over the cube's mass: for a person's fingertip and
// palm, and for the paper's hand. Prints CSV for plot_speed_against_mass.py.

#include <cmath>
#include <iostream>

#include "support/grips.h"
#include "text/files.h"

namespace mrhi {
namespace {

constexpr double kSpeed = 0.3;                        // of the hand [m/s]
constexpr double kSize = 0.1;                         // of the cube [m]
constexpr double kStart = 0.1, kRate = 120.0;         // of the impact [s], of frames [1/s]
constexpr double kPushed = 0.4;                       // duration of the hand's motion after the impact [s]
constexpr double kMinMass = 0.01, kMaxMass = 1000.0;  // masses [kg]
constexpr int kSteps = 50;

/// The whole hand translates: it does not close.
Hand hand_at(double t, bool palm) {
  const double surface = -0.5 * kSize - kSpeed * (kStart - t);
  Hand hand = testing::empty_hand();
  hand.palm.position = Vector3(surface - 0.1, 0, 0);
  // Each has one contact point.
  testing::add_fingertip(hand, palm ? kPalm : capsule_index(1, 3), Vector3(surface, 0, 0), -Vector3::UnitX());
  return hand;
}

struct Speeds {
  double impact = 0.0, pushed = 0.0;  // after the impact alone, and after kPushed [m/s]
};

Speeds speeds(double mass, bool palm, const HandStrength& strength) {
  Configuration configuration;
  configuration.filter.type = FilterKind::none;
  configuration.contact.hand = strength;
  Body cube = testing::stiff_box(Vector3::Constant(kSize), mass);
  Scene scene = testing::scene_of(cube);
  scene.bounds = {Vector3::Constant(-10.0), Vector3::Constant(10.0)};
  Simulation simulation(scene, configuration);
  Vector3 struck = Vector3::Zero();
  testing::play(
      simulation, 0.0, kStart + kPushed, kRate, [palm](double t) { return hand_at(t, palm); },
      [&](const Simulation& s) {
        for (const Contact& contact : s.result().contacts) struck += contact.impulse;
      });
  return {struck.norm() / mass, testing::object_twist(simulation).linear.norm()};
}

}  // namespace
}  // namespace mrhi

int main() {
  using namespace mrhi;
  std::cout << "hand,mass_kg,impact_m_s,pushed_m_s\n";
  const std::tuple<const char*, bool, HandStrength> hands[] = {
      {"fingertip", false, HandStrength::of_a_person()},
      {"palm", true, HandStrength::of_a_person()},
      {"paper", false, HandStrength()}};
  for (const auto& [name, palm, strength] : hands) {
    for (int i = 0; i <= kSteps; ++i) {
      const double mass = kMinMass * std::pow(kMaxMass / kMinMass, double(i) / kSteps);
      const Speeds found = speeds(mass, palm, strength);
      (CsvRows(std::cout) << name << mass << found.impact << found.pushed).end_row();
    }
  }
  return 0;
}
