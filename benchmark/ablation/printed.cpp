#include "support/printed_paper.h"
#include "support/slap.h"
#include "variant.h"

namespace mrhi::ablation {
namespace {

using testing::DraggedCube;

constexpr double kRate = 1000.0;  // frames and steps per second

double gain(bool as_printed) {
  return as_printed ? testing::kPrintedGain : 1.0;
}

/// Distance of a still hand, 0.3 m from its device, from where it is [m].
double misplaced(bool as_printed) {
  const Vector3 place(0.3, 0.0, 0.0);
  Configuration configuration = paper(as_printed).configuration;
  configuration.filter.type = FilterKind::window;  // Eq. 1
  configuration.filter.window = 3;
  Simulation simulation(testing::scene_of(DraggedCube::body()), configuration);
  testing::play(simulation, 0.0, 0.1, kRate, [&](double) {
    return testing::finger(place, place + Vector3(0.0, 0.02, 0.0), DraggedCube::kRadius);
  });
  return (simulation.result().tracked.at(0).capsules[capsule_index(1, 3)].start - place).norm();
}

/// A slap 2 cm off centre, without friction: error of the velocity and of the spin, relative to the closed
/// form.
Twist slap_error(bool as_printed) {
  constexpr double kLever = 0.02, kSpeed = 3.0, kRestitution = 0.5;
  Body body = testing::slab(Vector3::Constant(0.05), kRestitution);
  body.material.static_friction = body.material.dynamic_friction = 0.0;
  const Twist expected = testing::blow(body, kSpeed, kRestitution, 0.025, kLever);
  Simulation simulation(testing::scene_of(body), paper(as_printed).configuration);
  const auto hand = testing::hitter(kSpeed, 0.025, 0.0503, Vector3(0, 0, kLever));
  testing::play(simulation, 0.0, 0.054, kRate, [&](double t) {
    Hand shown = hand(t);
    for (Capsule& capsule : shown.capsules)
      capsule.start /= gain(as_printed), capsule.end /= gain(as_printed);
    return shown;
  });
  const Twist twist = testing::object_twist(simulation);
  return {(twist.linear - expected.linear) / expected.linear.norm(),
          (twist.angular - expected.angular) / expected.angular.norm()};
}

/// Depth of the skin in the cube when the first force acts on it [m].
double skin_depth_at_first_force(bool as_printed) {
  double depth = -1.0;
  Simulation simulation(testing::scene_of(DraggedCube::body()), paper(as_printed).configuration);
  testing::play(
      simulation, 0.0, 0.5, kRate, [&](double t) { return DraggedCube::hand(t, 0.004, gain(as_printed)); },
      [&](const Simulation& s) {
        for (const Contact& contact : s.state().contacts)
          if (depth < 0.0 && contact.force.norm() > 0.0) depth = contact.depth;
      });
  return depth;
}

/// How far the fingers drag the cube in a way of 6 cm, once they have slipped, each pressing as deep [m].
double dragged(bool as_printed) {
  constexpr double kDepth = 0.002, kDuring = 0.75;
  Simulation simulation(testing::scene_of(DraggedCube::body()), paper(as_printed).configuration);
  testing::play(simulation, 0.0, kDuring, kRate, [&](double t) {
    return DraggedCube::hand(t, as_printed ? kDepth : kDepth - DraggedCube::kRadius, gain(as_printed));
  });
  return simulation.state().bodies[0].pose.position.x();
}

constexpr double kWatched = 10.0;  // [s]

/// How long the cube of scene (a) stays in a still hand that came and closed round it, of kWatched; the
/// springs are as deep in it [s].
double stays(bool as_printed) {
  constexpr double kComes = 1.0, kGone = 0.05;  // [s], [m]
  Variant variant = paper(as_printed);
  variant.pinch.stiffness = DraggedCube::kStiffness;
  variant.pinch.overlap += as_printed ? variant.pinch.radius : 0.0;
  Simulation simulation(variant.pinch.scene(), variant.configuration);
  const auto hand_at = [&](double t) {
    Hand hand = variant.pinch.hand(t - kComes, Vector3(0.0, 0.0, -0.3 * (1.0 - testing::smooth(t, kComes))));
    for (Capsule& capsule : hand.capsules) capsule.start /= gain(as_printed), capsule.end /= gain(as_printed);
    hand.palm.position /= gain(as_printed);
    return hand;
  };
  double t = -kComes, stayed = kWatched;
  testing::play(simulation, 0.0, kComes + kWatched, kRate, hand_at, [&](const Simulation& s) {
    t += 1.0 / kRate;
    if (s.state().bodies[0].pose.position.norm() > kGone) stayed = std::min(stayed, t);
  });
  return stayed;
}

}  // namespace

Variant paper(bool as_printed) {
  Variant variant;
  variant.configuration = testing::unfiltered(ContactModelKind::seed);
  variant.configuration.contact.literal = as_printed;
  if (as_printed) variant.configuration.filter.window = 3;
  return variant;
}

const std::vector<PrintedDifference>& printed_differences() {
  static const std::vector<PrintedDifference> all{
      {"1", "a still hand 0.3 m from its device is shown off by", "mm",
       [](bool p) { return 1e3 * misplaced(p); }},
      {"9–15", "slap 2 cm off centre, no friction: error of v", "%",
       [](bool p) { return 1e2 * slap_error(p).linear.norm(); }},
      {"9–15", "the same: error of ω", "%", [](bool p) { return 1e2 * slap_error(p).angular.norm(); }},
      {"16", "the skin's depth as the first force acts", "mm",
       [](bool p) { return 1e3 * skin_depth_at_first_force(p); }},
      {"20", "two fingers slip along a cube: it goes, in 0.75 s", "mm",
       [](bool p) { return 1e3 * dragged(p); }},
      {"all", "(a) at 100 N/m, hand still: held, of 10 s", "s", stays},
  };
  return all;
}

}  // namespace mrhi::ablation
