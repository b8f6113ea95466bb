#include <gtest/gtest.h>

#include "support/grips.h"
#include "support/tessellated.h"

namespace mrhi {
namespace {

using namespace testing;

constexpr double kGravity = 9.81;      // [m/s^2]
constexpr double kRate = 60.0;         // frames [1/s]
constexpr double kSettled = 5.0;       // [s]
constexpr double kTenMinutes = 600.0;  // [s]
constexpr double kCreep = 0.01e-6;     // [m/s]

/// Scene (a)'s pinch, closed so far that friction could hold twice the cube's weight. Four fingers and a
/// thumb of stiffness k face each other: 4k and k in series.
PinchScene twice_the_friction_needed() {
  PinchScene pinch;
  const double friction = Material().static_friction;
  const double grip = 2.0 * pinch.mass * kGravity / friction;  // sum of the normal forces of both sides
  pinch.overlap = 0.25 * grip / (0.8 * pinch.stiffness);
  return pinch;
}

/// Average speed at which a cube moves in a still hand within ten minutes [m/s].
double creep(const Vector3& gravity) {
  const PinchScene pinch = twice_the_friction_needed();
  Configuration configuration = testing::implicit_configuration();
  configuration.gravity = gravity;
  Simulation simulation(pinch.scene(), configuration);
  Simulation weightless(pinch.scene(), testing::implicit_configuration());
  for (int frame = 0; frame < kRate; ++frame)
    weightless.advance({at(frame / kRate), {pinch.hand(frame / kRate, Vector3::Zero())}});
  simulation.set_state(weightless.state());
  Pose settled;
  const int frames = static_cast<int>((kSettled + kTenMinutes) * kRate);
  for (int frame = static_cast<int>(kRate); frame <= frames; ++frame) {
    const double t = frame / kRate;
    simulation.advance({at(t), {pinch.hand(t, Vector3::Zero())}});
    if (frame == static_cast<int>(kSettled * kRate)) settled = simulation.state().bodies[0].pose;
  }
  EXPECT_EQ(simulation.state().interactions[0].level, InteractionLevel::grasp);
  const Pose& pose = simulation.state().bodies[0].pose;
  const double corner = PinchScene().half * std::sqrt(3.0);
  return ((pose.position - settled.position).norm() +
          corner * pose.orientation.angularDistance(settled.orientation)) /
         kTenMinutes;
}

TEST(ImplicitCreep, a_pinched_cube_stays_where_it_is_for_ten_minutes_in_weightlessness) {
  const double speed = creep(Vector3::Zero());
  RecordProperty("creep_um_per_s", std::to_string(1e6 * speed));
  EXPECT_LE(speed, kCreep);
}

TEST(ImplicitCreep, a_pinched_cube_stays_where_it_is_for_ten_minutes_under_its_weight) {
  const double speed = creep(Vector3(0, 0, -kGravity));
  RecordProperty("creep_um_per_s", std::to_string(1e6 * speed));
  EXPECT_LE(speed, kCreep);
}

/// Thumb and index finger close round a rod that lies along their last phalanges, fast and at a tracker's
/// rate.
Hand round_a_rod(double rod_radius, double press, double t) {
  constexpr double kRadius = 0.009, kGap = 0.001, kClosing = 0.035;
  const double x = rod_radius + kRadius + kGap - (kGap + press) * smooth(t, kClosing);
  Hand hand = empty_hand();
  hand.palm.position = Vector3(0.02, 0.16, -0.02);
  const auto add = [&](int finger, int bone, const Vector3& start, const Vector3& end) {
    add_finger(hand, capsule_index(finger, bone), start, end, kRadius);
  };
  add(1, 0, {0.02, 0.14, 0}, {x + 0.02, 0.073, 0});
  add(1, 1, {x + 0.02, 0.073, 0}, {x + 0.01, 0.034, 0});
  add(1, 2, {x + 0.01, 0.034, 0}, {x, 0.0125, 0});
  add(1, 3, {x, 0.0125, 0}, {x, -0.0125, 0});
  add(0, 1, {-0.02, 0.13, 0}, {-x - 0.015, 0.072, 0});
  add(0, 2, {-x - 0.015, 0.072, 0}, {-x, 0.0125, 0});
  add(0, 3, {-x, 0.0125, 0}, {-x, -0.0125, 0});
  return hand;
}

TEST(ImplicitCreep, a_rod_along_the_fingers_comes_to_rest_with_the_shipped_filter) {
  const double press = 0.002;
  Configuration configuration;  // as shipped
  configuration.gravity = Vector3(0, 0, -kGravity);
  for (const double radius : {0.004, 0.006, 0.01}) {
    for (const Shape& shape : {Shape(Pill{radius, 0.03}), Shape(Cylinder{radius, 0.03})}) {
      Body rod = box_body({2 * radius, 0.06, 2 * radius}, 0.045);
      rod.material.stiffness = 2000.0;
      rod.material.static_friction = rod.material.dynamic_friction = 0.7;
      rod.shapes = {{shape, {Vector3::Zero(), Quaternion(Eigen::AngleAxisd(0.5 * M_PI, Vector3::UnitX()))}}};
      complete(rod);
      Simulation simulation(scene_of(rod), configuration);
      Pose settled;
      play(simulation, 0.0, 8.0, 115.0, [&](double t) {
        if (t <= 4.0) settled = simulation.state().bodies[0].pose;
        return round_a_rod(radius, press, t);
      });
      const Vector3 end = simulation.state().bodies[0].pose.position;
      ASSERT_LT(end.norm(), 0.02) << "held";
      EXPECT_LE((end - settled.position).norm() / 4.0, kCreep)
          << "radius " << radius << ", " << (std::holds_alternative<Pill>(shape) ? "capsule" : "cylinder");
    }
  }
}

/// Largest speed of the surface of a body of 0.05 kg in a still hand, a second after thumb and index finger
/// have closed across it, turned by `tilt` about z [m/s].
double unrest(Body body, double half, double tilt, double gravity) {
  Configuration configuration;  // as shipped
  configuration.gravity = Vector3(0, 0, -gravity);
  configuration.contact.grasp_assist = false;
  body.material.stiffness = 2000.0;
  Simulation simulation(scene_of(body), configuration);
  const Pose turn{Vector3::Zero(), Quaternion(Eigen::AngleAxisd(tilt, Vector3::UnitZ()))};
  double fastest = 0.0;
  play(simulation, 0.0, 1.5, 120.0, [&](double t) {
    const Twist twist = twist_of(simulation.scene().bodies[0], simulation.state().bodies[0]);
    if (t > 1.0) fastest = std::max(fastest, twist.linear.norm() + twist.angular.norm() * half);
    return moved(round_a_rod(half, 0.003, t), turn);
  });
  EXPECT_LT(simulation.state().bodies[0].pose.position.norm(), 0.01) << "held";
  return fastest;
}

// A fingertip that hangs over both edges of a narrow face is nearest to one of them as soon as it tilts. If
// it touched there alone, its load would leap from edge to edge, and such bodies rattle at some 0.1 m/s.
TEST(ImplicitCreep, a_body_narrower_than_a_fingertip_comes_to_rest_across_it) {
  for (const double half : {0.003, 0.005, 0.008, 0.01}) {
    const Vector3 bar(half, half, 0.075);
    std::vector<std::pair<const char*, Body>> bodies{{"bar", box_body(2.0 * bar, 0.05)},
                                                     {"cube", box_body(Vector3::Constant(2.0 * half), 0.05)}};
    const auto add = [&](const char* name, const TriangleMesh& mesh) {
      bodies.emplace_back(name, bodies.front().second);
      bodies.back().second.shapes.front().shape =
          Mesh{std::make_shared<const TriangleMesh>(mesh), "", Vector3::Ones()};
    };
    add("mesh of a bar", tessellated_box(bar, 2));
    add("mesh of a rounded bar", tessellated_rounded_bar(half, 0.001, 3, 0.075));
    add("mesh of a rod", tessellated_can(half, 0.075, 16, 1, 1));
    add("mesh of a fine rod", tessellated_can(half, 0.075, 32, 1, 1));
    for (const auto& [name, body] : bodies) {
      for (const double tilt : {0.0, 0.5, 3.0}) {
        for (const double gravity : {0.0, kGravity})
          EXPECT_LT(unrest(body, half, tilt * kDegrees, gravity), 1e-4)
              << name << " of " << 2e3 * half << " mm, " << tilt << " degrees, " << gravity << " m/s^2";
      }
    }
  }
}

}  // namespace
}  // namespace mrhi
