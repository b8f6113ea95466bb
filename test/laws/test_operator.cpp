// The operator floats: what hands do to objects and fixtures is done to the body that carries them.

#include <gtest/gtest.h>

#include <string>

#include "mr_hand_interaction/response/contact_model.h"
#include "mr_hand_interaction/scene/scene_loader.h"
#include "mr_hand_interaction/synthetic/scripted_motion.h"
#include "mr_hand_interaction/tracking/joints.h"
#include "support/pinch_scene.h"
#include "support/stability_map.h"

namespace mrhi {
namespace {

using namespace testing;

constexpr double kMass = 80.0;
const Vector3 kMoments(11.0, 12.0, 1.5);

/// The scene with an operator whose centre of mass is there, in a frame that is world at first.
Scene with_operator(Scene scene, const Vector3& centre, const std::string& name = "operator",
                    const Vector3& moments = kMoments) {
  Body body;
  body.name = name;
  body.is_operator = true;
  body.mass = kMass;
  body.inertia = moments.asDiagonal();
  body.link_in_body.position = -centre;
  body.start.position = centre;
  Operator op;
  op.body = static_cast<int>(scene.bodies.size());
  scene.bodies.push_back(body);
  scene.operators.push_back(op);
  scene.bounds = {Vector3::Constant(-500.0), Vector3::Constant(500.0)};
  return scene;
}

const BodyState& state_of(const Simulation& simulation, std::size_t op = 0) {
  return simulation.state().bodies[static_cast<std::size_t>(simulation.scene().operators[op].body)];
}
Twist operator_twist(const Simulation& simulation, std::size_t op = 0) {
  return object_twist(simulation, static_cast<std::size_t>(simulation.scene().operators[op].body));
}

/// Of all free bodies, and the largest that one of them has; angular about the origin.
struct Momentum {
  Vector3 linear = Vector3::Zero(), angular = Vector3::Zero();
  double largest_linear = 0.0, largest_angular = 0.0;

  explicit Momentum(const Simulation& simulation) {
    for (std::size_t b = 0; b < simulation.scene().bodies.size(); ++b) {
      if (simulation.scene().bodies[b].fixed) continue;
      const BodyState& state = simulation.state().bodies[b];
      const Vector3 turn = state.angular_momentum + state.pose.position.cross(state.linear_momentum);
      linear += state.linear_momentum, angular += turn;
      largest_linear = std::max(largest_linear, state.linear_momentum.norm());
      largest_angular = std::max(largest_angular, turn.norm());
    }
  }
};

/// Follows the sum of momenta, which the bodies began with.
class Balance {
 public:
  explicit Balance(const Simulation& simulation) : start_(simulation) {}
  void look(const Simulation& simulation) {
    const Momentum now(simulation);
    linear = std::max(linear, (now.linear - start_.linear).norm());
    angular = std::max(angular, (now.angular - start_.angular).norm());
    of_linear = std::max(of_linear, now.largest_linear);
    of_angular = std::max(of_angular, now.largest_angular);
  }
  /// Rounding of what is exchanged, step by step. The sum is of momenta of which each is rounded.
  void expect_kept(const std::string& what) const {
    EXPECT_GT(of_linear, 1e-4) << what << ": nothing was exchanged";
    EXPECT_LT(linear, 1e-12 * of_linear) << what;
    EXPECT_LT(angular, 1e-12 * std::max(of_linear, of_angular)) << what;
  }
  double linear = 0.0, angular = 0.0, of_linear = 0.0, of_angular = 0.0;

 private:
  Momentum start_;
};

// ---- Throwing.

struct Throw {
  Twist object, person;
  double linear, angular;  // what is missing from the balance
};

/// 1 kg in a pinch is brought to 2 m/s against the world within half a second and released.
Throw throw_cube(const Vector3& centre, const Vector3& moments, double step, double rate) {
  PinchScene pinch;
  pinch.mass = 1.0;
  pinch.stiffness = 20000.0;
  Configuration configuration = unfiltered(ContactModelKind::implicit);
  configuration.step = step;
  Simulation simulation(with_operator(pinch.scene(), centre, "operator", moments), configuration);
  Balance balance(simulation);
  const double speed = 2.0 * (1.0 + 1.0 / kMass), begin = 0.3, duration = 0.5;
  const auto way = [&](double t) -> Vector3 {  // the hand goes on at that speed
    const double x = std::clamp((t - begin) / duration, 0.0, 1.0);
    const double accelerating = speed * duration * x * x * x * (1.0 - 0.5 * x);
    return Vector3((accelerating + speed * std::max(0.0, t - begin - duration)), 0, 0);
  };
  for (double t = 0.0; t < 1.0; t += 1.0 / rate) {
    Hand hand = pinch.hand(t, way(t));
    if (t > begin + duration + 0.05) {  // opens along y, across the way
      for (Capsule& capsule : hand.capsules) {
        const double gap = (t - begin - duration - 0.05) * (capsule.start.x() > way(t).x() ? 1.0 : -1.0);
        capsule.start.x() += gap, capsule.end.x() += gap;
      }
    }
    simulation.advance({at(t), {hand}});
    balance.look(simulation);
  }
  balance.expect_kept("throw");
  return {object_twist(simulation), operator_twist(simulation), balance.linear, balance.angular};
}

TEST(Operator, who_throws_a_kilogram_at_2_m_per_s_recoils_at_0_025_m_per_s) {
  for (const double step : {0.001, 1.0 / 120.0}) {
    const Throw thrown = throw_cube(Vector3::Zero(), kMoments, step, 120.0);
    EXPECT_NEAR(thrown.object.linear.x(), 2.0, 0.02);  // the fingers open from both sides
    EXPECT_NEAR(thrown.person.linear.x(), -thrown.object.linear.x() / kMass, 1e-14);
    EXPECT_NEAR(thrown.person.linear.x(), -0.025, 3e-4);
    EXPECT_LT(thrown.person.angular.norm(), 1e-3);
  }
}

/// The throw passes the centre of mass at 0.4 m, so that the spin about z is m v 0.4 m / I_z. Of a person who
/// turns so little in the throw that its direction stays.
TEST(Operator, who_throws_beside_the_centre_of_mass_spins_by_the_arm) {
  const double arm = 0.4;
  const Vector3 moments(100.0, 120.0, 150.0);
  const Throw thrown = throw_cube(Vector3(0, -arm, 0), moments, 0.001, 120.0);
  const double spin = thrown.object.linear.x() * arm / moments.z();
  EXPECT_NEAR(thrown.person.angular.z(), spin, 0.01 * spin);
}

// ---- Conservation.

/// Follows, step by step, what the operator gets and what its hands give to objects and fixtures.
class StepBalance {
 public:
  bool step(Simulation& simulation) {
    const BodyState before = state_of(simulation);
    if (!simulation.step()) return false;
    Twist given;  // of the hands, angular about the operator's centre
    // Contacts of the step are at the poses of its start.
    const double seconds = to_seconds(simulation.time() - last_time_);
    last_time_ = simulation.time();
    const SimulationState& state = simulation.state();
    for (const Contact& contact : state.contacts) {
      const Vector3 impulse = seconds * contact.force + contact.impulse;
      given.linear += impulse;
      given.angular +=
          (contact.point - before.pose.position).cross(impulse) + seconds * contact.torque * contact.normal;
      force = std::max(force, contact.force.norm());
    }
    const BodyState& after = state_of(simulation);
    linear = std::max(linear, (after.linear_momentum - before.linear_momentum + given.linear).norm());
    angular = std::max(angular, (after.angular_momentum - before.angular_momentum + given.angular).norm());
    most = std::max(most, after.linear_momentum.norm());
    return true;
  }
  double linear = 0.0, angular = 0.0, most = 0.0, force = 0.0;

 private:
  Nanoseconds last_time_ = kStart;
};

Simulation scripted(const ScriptedMotion& motion, bool assist) {
  Configuration configuration;  // as shipped: a person's hand through the default filter
  configuration.contact.grasp_assist = assist;
  SceneOptions options;
  options.default_material = default_material(configuration);
  Scene scene = load_scene("config/scenes/" + motion.scene + ".urdf", options);
  scene.gravity.setZero();
  if (!scene.bodies[0].fixed) free_body(scene, scene.bodies[0].name).start_twist = motion.object_twist;
  return Simulation(with_operator(scene, Vector3(0, -0.4, 0)), configuration);
}

/// A frame of the motion, as the default tracker gives it.
HandFrame frame_of(const ScriptedMotion& motion, double t) {
  HandFrame frame{at(t), {}};
  for (const HandJoints& hand : sample(motion, Side::right, at(t) - kStart, default_device_mount()).hands)
    frame.hands.push_back(complete_hand(hand, default_device_mount()));
  return frame;
}

/// Where fixtures or joints take up momentum, what the operator gets is what its hands give, in each step.
TEST(Operator, keeps_the_momenta_of_objects_and_operator_over_every_scripted_motion) {
  int free = 0, all = 0;
  for (const std::string& name : motion_names()) {
    const ScriptedMotion motion = make_motion(name);
    SceneOptions options;
    const Scene scene = load_scene("config/scenes/" + motion.scene + ".urdf", options);
    const bool held_by_world =
        std::any_of(scene.bodies.begin(), scene.bodies.end(), [](const Body& body) { return body.fixed; }) ||
        !scene.joints.empty();
    ++all, free += !held_by_world;
    for (const bool assist : {false, true}) {
      Simulation simulation = scripted(motion, assist && !held_by_world);
      Balance balance(simulation);
      StepBalance steps;
      // Steps of whole nanoseconds, so that their lengths are known to rounding.
      for (double t = 0.0; t < motion.run_time(); t += 0.008) {
        if (!held_by_world) {
          simulation.advance(frame_of(motion, t));
          balance.look(simulation);
          continue;
        }
        ASSERT_EQ(simulation.begin(frame_of(motion, t)), Rejection::none);
        while (steps.step(simulation)) {
        }
        simulation.end();
      }
      if (!held_by_world) {
        balance.expect_kept(name + (assist ? " with assist" : ""));
        continue;
      }
      EXPECT_GT(steps.most, 1e-4) << name << ": nothing was exchanged";
      EXPECT_LT(steps.linear, 1e-12 * steps.most) << name;
      EXPECT_LT(steps.angular, 1e-12 * steps.most) << name;
      break;
    }
  }
  EXPECT_GE(free, 8);
  EXPECT_GE(all, 16);
}

// ---- Rails.

constexpr double kTip = 0.008, kHalfRail = 0.01;

/// A rail of 20 mm along x.
Body rail(double length, double stiffness = 2000.0) {
  Body body = box_body(Vector3(length, 2 * kHalfRail, 2 * kHalfRail), 1.0);
  body.name = "rail";
  body.fixed = true;
  body.start.position.x() = 0.5 * length;
  body.material.stiffness = stiffness;
  complete(body);
  return body;
}

/// Four fingers and the thumb on both sides of the rail at x, `closed` from 0, 20 mm off, to 1, 3 mm deep.
Hand grip_rail(std::uint32_t id, double x, double closed) {
  Hand hand = empty_hand();
  hand.id = id;
  hand.side = id == 1 ? Side::left : Side::right;
  hand.palm.position = Vector3(x, 0, 0.06);
  const double off = kHalfRail + kTip + 0.02 - 0.023 * closed;
  for (int finger = 0; finger < kFingers; ++finger) {
    const double y = finger == 0 ? -off : off;
    const Vector3 tip(x + (finger == 0 ? 0.0 : 0.014 * (finger - 2.5)), y, 0.0);
    add_finger(hand, capsule_index(finger, 3), tip - Vector3(0, 0, 0.008), tip + Vector3(0, 0, 0.008), kTip);
  }
  return hand;
}

Simulation at_rail(double length, const Vector3& centre, double step, const HandStrength& strength,
                   double stiffness = 2000.0) {
  Configuration configuration = unfiltered(ContactModelKind::implicit);
  configuration.step = step;
  configuration.contact.hand = strength;
  return Simulation(with_operator(scene_of(rail(length, stiffness)), centre), configuration);
}

/// A pull over 0.4 m in 2 s, with acceleration and jerk 0 at both ends: nothing swings that is held by
/// springs. The hand holds, so that the operator goes the other way, and the fixture's force is M a.
TEST(Operator, pull_on_a_rail_is_mass_times_acceleration) {
  for (const double step : {0.001, 1.0 / 120.0}) {
    Simulation simulation = at_rail(2.0, Vector3::Zero(), step, HandStrength{}, 20000.0);
    const double way = 0.4, duration = 2.0, begin = 0.5;
    double worst = 0.0, most = 0.0;
    for (double t = 0.0; t < 3.0; t += 1.0 / 120.0) {
      const double x = std::clamp((t - begin) / duration, 0.0, 1.0);
      const double pulled = way * x * x * x * x * (35.0 + x * (-84.0 + x * (70.0 - 20.0 * x)));
      simulation.advance({at(t), {grip_rail(2, 0.8 - pulled, smooth(t, 0.3))}});
      const double middle = std::clamp((t - begin - 0.5 / 120.0) / duration, 0.0, 1.0);  // forces are means
      const double acceleration = way / (duration * duration) * 420.0 * middle * middle * (1.0 - middle) *
                                  (1.0 - middle) * (1.0 - 2.0 * middle);
      Vector3 force = Vector3::Zero();
      for (const Contact& contact : simulation.result().contacts) force += contact.force;
      if (t < begin + 0.2) continue;
      worst = std::max(worst, std::abs(-force.x() - kMass * acceleration));
      most = std::max(most, kMass * std::abs(acceleration));
    }
    EXPECT_GT(most, 45.0);
    EXPECT_LT(worst, 0.03 * most) << step;
    EXPECT_NEAR(state_of(simulation).pose.position.x(), way, 0.002) << step;
    EXPECT_LT(operator_twist(simulation).linear.norm(), 0.005) << step;  // of 0.44 m/s on the way
  }
}

/// Crawls hand over hand with a person's hands.
class Crawl {
 public:
  static constexpr double kFrame = 0.008;  // [s], so that steps are whole nanoseconds

  explicit Crawl(double step)
      : simulation_(at_rail(160.0, Vector3(0.0, -0.05, 0.0), step, HandStrength::of_a_person())) {
    SimulationState state = simulation_.state();
    state.bodies[1].pose.position.x() += 10.0;
    simulation_.set_state(state);
  }
  /// The momentum that fixtures gave is what the operator has.
  void run(double seconds) {
    constexpr double kStroke = 0.25, kPeriod = 2.5;  // [m], [s]
    for (double t = 0.0; t < seconds; t += kFrame) {
      HandFrame frame{at(t), {}};
      for (const std::uint32_t id : {1u, 2u}) {
        const double phase = std::fmod(t + (id == 1 ? 0.0 : 0.5 * kPeriod), kPeriod) / kPeriod;
        // Pulls in the first 0.55 of a period, with an overlap of both hands, and reaches in the rest.
        const double pulled = phase < 0.55 ? phase / 0.55 : 1.0 - smooth(phase - 0.6, 0.35);
        const double closed =
            smooth(phase + 0.05, 0.05) - smooth(phase - 0.5, 0.05) + smooth(phase - 0.95, 0.05);
        frame.hands.push_back(grip_rail(id, 0.4 - kStroke * pulled, std::clamp(closed, 0.0, 1.0)));
      }
      ASSERT_EQ(simulation_.begin(frame), Rejection::none);
      while (balance_.step(simulation_)) {
      }
      simulation_.end();
      for (const Event& event : simulation_.result().events)
        lost_ = lost_ || event.kind == EventKind::out_of_bounds;
    }
  }
  Simulation simulation_;
  StepBalance balance_;
  bool lost_ = false;
};

/// Momentum that a step gives the operator equals the impulse of its contacts, to rounding. Steps of 1 ms are
/// played for one minute: each of these 60 000 steps is checked.
TEST(Operator, crawls_along_a_rail_for_ten_minutes_and_keeps_the_balance_with_the_fixture) {
  for (const auto& [step, duration] : {std::pair(0.001, 60.0), std::pair(Crawl::kFrame, 600.0)}) {
    Crawl crawl(step);
    const double from = state_of(crawl.simulation_).pose.position.x();
    crawl.run(duration);
    const double speed = (state_of(crawl.simulation_).pose.position.x() - from) / duration;
    EXPECT_FALSE(crawl.lost_);
    EXPECT_GT(speed, 0.1) << "people go 0.1 to 0.3 m/s along a rail";
    EXPECT_LT(speed, 0.3);
    EXPECT_LT(std::abs(state_of(crawl.simulation_).pose.position.y() + 0.05), 0.1);
    EXPECT_GT(crawl.balance_.most, 10.0);
    EXPECT_LT(crawl.balance_.linear, 1e-14 * crawl.balance_.most);
    EXPECT_LT(crawl.balance_.angular, 1e-14 * crawl.balance_.most);  // at arms of up to a metre
  }
}

/// 600 N are asked of fingers that bear 16 N each.
TEST(Operator, pull_beyond_the_hands_strength_slips_off_and_the_rail_is_lost) {
  Simulation simulation = at_rail(2.0, Vector3::Zero(), 0.001, HandStrength::of_a_person());
  bool held = false, lost = false;
  double most = 0.0;
  for (double t = 0.0; t < 2.0; t += 1.0 / 120.0) {
    const double pulled = 0.6 * smooth(t - 0.6, 0.5);
    const double lifted = 0.2 * smooth(t - 0.8, 0.4);  // across the rail, which the fingers give up
    Hand hand = grip_rail(2, 0.8 - pulled, smooth(t, 0.3));
    for (Capsule& capsule : hand.capsules) capsule.start.z() += lifted, capsule.end.z() += lifted;
    simulation.advance({at(t), {hand}});
    Vector3 force = Vector3::Zero();
    for (const Contact& contact : simulation.result().contacts) force += contact.force;
    most = std::max(most, force.norm());
    for (const Event& event : simulation.result().events) {
      held = held || event.kind == EventKind::grasp_begin;
      lost = lost || (held && event.kind == EventKind::grasp_end);
    }
  }
  EXPECT_TRUE(held);
  EXPECT_TRUE(lost);
  EXPECT_LT(most, 130.0);
  EXPECT_LT(state_of(simulation).pose.position.x(), 0.55);  // the hand slid along the rail
}

// ---- Pushing off.

/// A hand flat on the wall y = 0, pressed in by `depth`.
Hand on_wall(std::uint32_t id, double x, double depth) {
  Hand hand = empty_hand();
  hand.id = id;
  hand.side = id == 1 ? Side::left : Side::right;
  const double y = depth - kTip;
  for (int finger = 0; finger < kFingers; ++finger) {
    const double across = x + 0.02 * (finger - 2);
    add_finger(hand, capsule_index(finger, 3), Vector3(across, y, 0.08), Vector3(across, y, 0.1), kTip);
  }
  add_finger(hand, kPalm, Vector3(x - 0.03, y - 0.007, 0), Vector3(x + 0.03, y - 0.007, 0), kTip + 0.007);
  hand.palm.position = Vector3(x, y, 0);
  return hand;
}

/// Astronauts on the KC-135 pushed off with 151 N of a hand on average, and 267 N at most (Klute 1992). Both
/// arms stretch by 0.3 m in 0.5 s here.
TEST(Operator, push_off_is_as_strong_as_astronauts_are_and_no_stronger) {
  Body wall = box_body(Vector3(2, 0.2, 2), 1.0);
  wall.fixed = true;
  wall.start.position.y() = 0.1;
  wall.material.stiffness = 2000.0;
  complete(wall);
  Configuration configuration;
  configuration.filter.type = FilterKind::none;
  Simulation simulation(with_operator(scene_of(wall), Vector3(0, -0.5, 0)), configuration);
  double most = 0.0;
  for (double t = 0.0; t < 2.0; t += 1.0 / 120.0) {
    const double stretched = -0.002 + 0.3 * smooth(t - 0.2, 0.5);
    simulation.advance({at(t), {on_wall(1, -0.2, stretched), on_wall(2, 0.2, stretched)}});
    Vector3 force = Vector3::Zero();
    for (const Contact& contact : simulation.result().contacts) force += contact.force;
    most = std::max(most, force.norm());
  }
  EXPECT_GT(most, 151.0);  // both hands
  EXPECT_LT(most, 2.0 * 151.0);
  EXPECT_LT(operator_twist(simulation).linear.y(), -0.3);
  EXPECT_GT(operator_twist(simulation).linear.y(), -1.0);
  RecordProperty("newtons", std::to_string(most));
  RecordProperty("speed", std::to_string(-operator_twist(simulation).linear.y()));
}

// ---- Two operators and one crate.

TEST(Operator, two_and_the_crate_that_they_hold_keep_all_momentum) {
  SceneOptions options;
  options.default_material = default_material(unfiltered(ContactModelKind::implicit));
  Scene scene = load_scene("config/scenes/crate.urdf", options);
  scene =
      with_operator(with_operator(scene, Vector3(-0.5, -0.4, 0.3), "ann"), Vector3(0.5, -0.4, 0.3), "ben");
  for (const double step : {0.001, 1.0 / 120.0}) {
    Configuration configuration = unfiltered(ContactModelKind::implicit);
    configuration.step = step;
    Simulation simulation(scene, configuration);
    Balance balance(simulation);
    const Vector3 crate(0.0, 0.25, 0.3), along(0, 0, 0.015);
    for (double t = 0.0; t < 6.0; t += 1.0 / 120.0) {
      HandFrame frame{at(t), {}};
      for (const std::uint32_t id : {2u, 3u}) {  // of ann and ben
        Hand hand = empty_hand();
        hand.id = id;
        const double sign = id == 2 ? -1.0 : 1.0;
        const Vector3 place = crate + Vector3(0.49 * sign, 0, 0) +
                              smooth(t - 1.0, 2.0) * Vector3(0.05 * sign, 0.1, id == 2 ? 0.1 : 0.0);
        const double off = kHalfRail + kTip + 0.01 - 0.013 * smooth(t, 0.5) + 0.03 * smooth(t - 4.0, 0.5);
        for (const int side : {1, -1}) {
          const Vector3 tip = place + Vector3(0, side * off, 0);
          add_finger(hand, capsule_index(side > 0 ? 1 : 0, 3), tip - along, tip + along, kTip);
        }
        hand.palm.position = place;
        frame.hands.push_back(hand);
      }
      simulation.advance(frame);
      balance.look(simulation);
    }
    balance.expect_kept("crate");
    EXPECT_LT(operator_twist(simulation, 0).linear.norm(), 0.2);
    EXPECT_GT((operator_twist(simulation, 0).linear - operator_twist(simulation, 1).linear).norm(), 1e-4);
  }
}

// ---- Free flight.

TEST(Operator, drifts_and_turns_as_a_free_body_and_takes_the_hands_along) {
  Scene scene = with_operator(scene_of(ball_body(0.02, 0.1)), Vector3(0, -0.4, 0));
  scene.bodies[0].start.position = Vector3(0, 5, 5);
  scene.bodies[1].start_twist = {Vector3(0.01, 0, 0), Vector3(0.2, 0.1, 0.05)};
  Simulation simulation(scene, unfiltered(ContactModelKind::implicit));
  const Vector3 tip(0.1, 0.2, 0.3);
  const Vector3 momentum = start_state(simulation.scene().bodies[1]).angular_momentum;
  for (double t = 0.0; t < 60.0; t += 1.0 / 60.0) {
    simulation.advance({at(t), {finger(tip, tip, kTip)}});
    const BodyState& body = state_of(simulation);
    const Vector3 seen = simulation.result().tracked[0].capsules[capsule_index(1, 3)].start;
    ASSERT_NEAR((seen - body.pose * (tip + Vector3(0, 0.4, 0))).norm(), 0.0, 1e-12);
    ASSERT_EQ(body.angular_momentum, momentum);
  }
  EXPECT_NEAR(state_of(simulation).pose.position.x(), 0.01 * 60.0, 1e-3);
  EXPECT_GT(state_of(simulation).pose.orientation.angularDistance(Quaternion::Identity()), 0.1);
}

// ---- Stability.

TEST(Operator, makes_no_cell_of_the_stability_map_diverge_or_fly_off) {
  const StabilityGrid grid{{0.001, 0.03, 1.0, 100.0},
                           {0.00025, 0.001, 0.004, 1.0 / 60.0},
                           {50.0, 2000.0, 1e5},
                           {1, 2, 5, 10, 20},
                           {0.0, 0.5, 1.0}};
  int cells = 0;
  grid.for_every_cell(ContactModelKind::implicit, [&](const StabilityCell& cell) {
    const StabilityResult result = StabilityRun(cell, [](const Scene& scene) {
                                     return with_operator(scene, Vector3(0, -0.4, 0));
                                   }).play();
    EXPECT_TRUE(result.outcome == StabilityOutcome::stable || result.outcome == StabilityOutcome::let_go)
        << cell << ": " << result.largest_speed << " m/s, slid " << 1e3 * result.slid << " mm";
    ++cells;
  });
  EXPECT_EQ(cells, 720);
}

// ---- Tethers and restraints.

TEST(Operator, tether_only_pulls_and_is_never_longer_than_it_is) {
  for (const double step : {0.001, 1.0 / 120.0}) {
    Scene scene = with_operator(scene_of(rail(1.0)), Vector3(0, -1.0, 0));
    scene.tethers.push_back({1, 0, Vector3(0, 0.1, 0), Vector3::Zero(), 1.5});
    scene.bodies[1].start_twist.linear = Vector3(0.3, -0.2, 0.1);
    Configuration configuration = unfiltered(ContactModelKind::implicit);
    configuration.step = step;
    Simulation simulation(scene, configuration);
    double longest = 0.0, energy = 1e9;
    const double at_start = kinetic_energy(simulation.scene().bodies[1], state_of(simulation));
    for (double t = 0.0; t < 60.0; t += 1.0 / 120.0) {
      simulation.advance({at(t), {}});
      const Vector3 end = state_of(simulation).pose * Vector3(0, 0.1, 0);
      longest = std::max(longest, (end - simulation.state().bodies[0].pose.position).norm());
      energy = kinetic_energy(simulation.scene().bodies[1], state_of(simulation));
      ASSERT_LE(energy, at_start * 1.0001);
    }
    EXPECT_GT(longest, 1.499);
    EXPECT_LT(longest, 1.501);
  }
}

TEST(Operator, restraint_holds_against_what_the_hands_do) {
  PinchScene pinch;
  Simulation simulation(with_operator(pinch.scene(), Vector3(0, -0.4, 0)),
                        unfiltered(ContactModelKind::implicit));
  SimulationState state = simulation.state();
  state.restrained[0] = 1;
  simulation.set_state(state);
  const Pose before = state_of(simulation).pose;
  play(simulation, 0.0, 1.0, 120.0,
       [&](double t) { return pinch.hand(t, swing(t, 0.05 * smooth(t - 0.4, 0.1), 3.0)); });
  EXPECT_GT(simulation.state().bodies[0].linear_momentum.norm(), 1e-3);
  EXPECT_EQ(state_of(simulation).pose.position, before.position);
}

}  // namespace
}  // namespace mrhi
