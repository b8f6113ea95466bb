#include <gtest/gtest.h>

#include "response/contact_step.h"
#include "response/impact.h"
#include "response/impact_solver.h"
#include "support/fixtures.h"

namespace mrhi {
namespace {

using testing::box_body;
using testing::finger;
using testing::object_twist;
using testing::play;
using testing::scene_of;
using testing::unfiltered;

constexpr double kRadius = 0.008;
constexpr double kHalf = 0.025;

Body cube(double restitution) {
  Body body = box_body(Vector3::Constant(2.0 * kHalf), 0.05);
  body.material.restitution = restitution;
  return body;
}

/// A fingertip (its axis across the face) that comes along +x at `speed` and is at the face at t = 0.05 s,
/// `offset` off the face's centre; taken away right after the blow.
std::function<Hand(double)> striker(double speed, const Vector3& offset) {
  return [=](double t) {
    const double x = t < 0.055 ? speed * (t - 0.05) - kHalf - kRadius : -1.0;
    const Vector3 tip = offset + Vector3(x, 0.0, 0.0);
    return finger(tip - Vector3(0, 0.0125, 0), tip + Vector3(0, 0.0125, 0), kRadius);
  };
}

Twist struck(Body body, double speed, const Vector3& offset) {
  Configuration configuration = unfiltered(ContactModelKind::impulse);
  configuration.tracking.max_speed = 50.0;
  Simulation simulation(scene_of(std::move(body)), configuration);
  play(simulation, 0.0, 0.054, 1000.0, striker(speed, offset));
  return object_twist(simulation);
}

/// What is left of Newton's blow against a mass [kg] that comes at 1 m/s, if another law gives `least`, both
/// over twice the mass's momentum: of either more than 1 gives back more than was there.
double kept_of(double newtons, double least, double mass = 0.5) {
  const Vector3 approach = Vector3::UnitX(), most = 2.0 * mass * approach;
  const auto after = [&](double impulse) -> Vector3 { return (1.0 - 2.0 * impulse) * approach; };
  std::vector<ImpactLaws> points{{approach, newtons * most, after(newtons), least * most, after(least)}};
  keep_from_gaining(points);
  return points[0].newtons.x() / most.x();
}

TEST(Impact, keeps_of_newtons_blow_what_makes_no_energy) {
  EXPECT_NEAR(kept_of(0.8, 0.5), 0.8, 1e-12);
  EXPECT_NEAR(kept_of(1.4, 0.5), 1.0, 1e-12);
  for (const double mass : {0.5, 1e-6, 1e6})
    EXPECT_NEAR(kept_of(2.0, 1.5, mass), 1.0, 1e-12) << "the blow without restitution makes some, too";
}

// Newton's law with a heavy hand: v = (1 + e) u. The tolerance is that of arithmetic: the blow is one
// impulse.
TEST(Impact, leaves_at_one_plus_restitution_times_the_hands_speed) {
  for (const double restitution : {0.0, 0.3, 0.5, 1.0}) {
    const Twist twist = struck(cube(restitution), 3.0, Vector3::Zero());
    EXPECT_NEAR(twist.linear.x(), 3.0 * (1.0 + restitution), 1e-9) << restitution;
    EXPECT_NEAR(twist.linear.tail<2>().norm(), 0.0, 1e-9);
    EXPECT_NEAR(twist.angular.norm(), 0.0, 1e-9);
  }
}

TEST(Impact, off_centre_blow_gives_the_spin_of_the_collision_matrix) {
  const double restitution = 0.5, speed = 1.0, lever = 0.015;
  const Body body = cube(restitution);
  const Twist twist = struck(body, speed, Vector3(0, 0, lever));
  const double inertia = body.inertia(1, 1);
  const double j = (1.0 + restitution) * speed / (1.0 / body.mass + lever * lever / inertia);
  EXPECT_NEAR(twist.linear.x(), j / body.mass, 1e-9);
  EXPECT_NEAR(twist.angular.y(), j * lever / inertia, 1e-6);
  EXPECT_NEAR(twist.angular.x(), 0.0, 1e-9);
}

/// A bare contact in the middle of the cube's -x face, and the step that it is in.
struct Blow {
  explicit Blow(double restitution, const Vector3& hand_velocity) : scene(scene_of(cube(restitution))) {
    bodies.push_back(start_state(scene.bodies[0]));
    contacts.resize(1);
    contacts[0].normal = -Vector3::UnitX();
    contacts[0].point = Vector3(-kHalf, 0, 0);
    contacts[0].hand_velocity = hand_velocity;
  }
  void strike(ImpactFriction friction = ImpactFriction::none) {
    std::vector<BodyContact> none;
    StepChanges changes;
    changes.reset(1);
    std::vector<Grip> grips;
    const ContactConfiguration configuration;
    ContactStep step{scene, scene.gravity, 0.001, configuration, contacts, none, bodies, changes, grips};
    Islands islands;
    islands.build(step);
    ImpactSolver().resolve(step, islands, friction);
  }
  double normal_velocity() const {
    return contacts[0].normal.dot(relative_velocity(contacts[0], scene.bodies[0], bodies[0]));
  }
  Scene scene;
  std::vector<BodyState> bodies;
  std::vector<Contact> contacts;
};

TEST(Impact, relative_speed_at_the_point_reverses_by_restitution) {
  Blow blow(0.7, Vector3(2.0, 0.3, 0.0));
  blow.bodies[0].angular_momentum = Vector3(1e-5, -2e-5, 3e-5);
  blow.contacts[0].point = Vector3(-kHalf, 0.01, -0.02);
  const double before = blow.normal_velocity();
  blow.strike();
  EXPECT_LT(before, 0.0);
  EXPECT_NEAR(blow.normal_velocity(), -0.7 * before, 1e-12);
}

// Off the centre the tangential response is not the same in both directions. Coulomb's law is a matter of the
// velocity all the same: to the solver's precision.
TEST(Impact, friction_opposes_the_sliding_that_remains) {
  Blow blow(0.3, Vector3(2.0, 1.5, 1.0));
  blow.contacts[0].point = Vector3(-kHalf, 0.02, 0.005);
  Body& body = blow.scene.bodies[0];
  body.material.static_friction = body.material.dynamic_friction = 0.05;
  blow.strike(ImpactFriction::coulomb);
  const Vector3 normal = blow.contacts[0].normal, impulse = blow.contacts[0].impulse;
  const Vector3 friction = impulse - normal.dot(impulse) * normal;
  const Vector3 velocity = relative_velocity(blow.contacts[0], body, blow.bodies[0]);
  const Vector3 sliding = velocity - normal.dot(velocity) * normal;
  EXPECT_GT(sliding.norm(), 0.1);
  EXPECT_NEAR(friction.norm(), 0.05 * std::abs(normal.dot(impulse)), 1e-12);
  EXPECT_NEAR(friction.normalized().dot(sliding.normalized()), 1.0, 1e-12);
}

TEST(Impact, one_approach_is_one_blow) {
  Blow blow(0.5, Vector3(1.0, 0, 0));
  blow.strike();
  const Vector3 momentum = blow.bodies[0].linear_momentum;
  EXPECT_GT(momentum.x(), 0.0);
  blow.contacts[0].hand_velocity = Vector3(5.0, 0, 0);
  blow.strike();
  EXPECT_EQ(blow.bodies[0].linear_momentum, momentum);
}

TEST(Impact, a_parting_or_resting_contact_gets_no_impulse) {
  for (const double speed : {-1.0, 0.0}) {
    Blow blow(0.5, Vector3(speed, 0, 0));
    blow.contacts[0].depth = 0.001;
    blow.strike();
    EXPECT_EQ(blow.bodies[0].linear_momentum, Vector3::Zero()) << speed;
  }
}

TEST(Impact, blows_at_several_points_act_together) {
  Blow blow(0.5, Vector3(1.0, 0, 0));
  blow.contacts.resize(4, blow.contacts[0]);
  const double lever = 0.02;
  blow.contacts[0].point += Vector3(0, lever, lever);
  blow.contacts[1].point += Vector3(0, lever, -lever);
  blow.contacts[2].point += Vector3(0, -lever, lever);
  blow.contacts[3].point += Vector3(0, -lever, -lever);
  blow.strike();
  const Twist twist = twist_of(blow.scene.bodies[0], blow.bodies[0]);
  EXPECT_NEAR(twist.linear.x(), 1.5, 1e-10);
  EXPECT_NEAR(twist.angular.norm(), 0.0, 1e-9);
}

TEST(Impact, impulse_on_the_object_is_what_the_contact_reports) {
  Simulation simulation(scene_of(cube(0.5)), unfiltered());
  Vector3 reported = Vector3::Zero();
  play(simulation, 0.0, 0.054, 1000.0, striker(1.0, Vector3(0, 0, 0.005)), [&](const Simulation& s) {
    for (const Contact& contact : s.result().contacts) reported += contact.impulse;
  });
  EXPECT_GT(reported.x(), 0.0);
  // The spring has hardly begun to act: 1 ms of contact at a few tenths of a millimetre.
  EXPECT_NEAR((simulation.state().bodies[0].linear_momentum - reported).norm(), 0.0, 0.02 * reported.norm());
}

}  // namespace
}  // namespace mrhi
