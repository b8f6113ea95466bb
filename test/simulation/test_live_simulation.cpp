#include "mr_hand_interaction/live_simulation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "mr_hand_interaction/parameters.h"
#include "mr_hand_interaction/scene/scene_loader.h"
#include "support/pinch_scene.h"

namespace mrhi {
namespace {

using testing::at;

constexpr double kRate = 120.0;

Body ball_at(const Vector3& place, const std::string& name, const Vector3& velocity = Vector3::Zero()) {
  Body ball = testing::ball_body(0.02, 0.05);
  ball.name = name;
  ball.start.position = place;
  ball.start_twist.linear = velocity;
  return ball;
}

/// A hand that holds a cube and swings it, with a ball that flies by; bodies before and after the cube.
class Held {
 public:
  explicit Held(const Configuration& configuration = testing::unfiltered(ContactModelKind::implicit))
      : live_(scene(), configuration) {}

  void play(double until) {
    for (; frame_ <= std::lround(until * kRate); ++frame_) {
      const double t = static_cast<double>(frame_) / kRate;
      const Vector3 sway = t < 0.5 ? Vector3::Zero() : testing::swing(t - 0.5, 0.05, 1.0);
      live_.simulation().advance({at(t), {pinch_.hand(t, sway)}});
      for (const Event& event : live_.simulation().result().events) kinds.push_back(event.kind);
    }
  }

  LiveSimulation& live() { return live_; }
  Simulation& simulation() { return live_.simulation(); }
  std::size_t index(const std::string& name) const {
    return static_cast<std::size_t>(*find_body(live_.simulation().scene(), name));
  }
  const BodyState& state(const std::string& name) const {
    return live_.simulation().state().bodies[index(name)];
  }
  Twist twist(const std::string& name) const {
    return twist_of(live_.simulation().scene().bodies[index(name)], state(name));
  }
  std::vector<Contact> contacts_with(const std::string& name) const {
    std::vector<Contact> found;
    for (const Contact& contact : live_.simulation().state().contacts) {
      if (contact.key.body == index(name) && contact.touching()) found.push_back(contact);
    }
    return found;
  }
  bool holds() const {
    const SimulationState& state = live_.simulation().state();
    return state.interactions[index("object")].level == InteractionLevel::grasp;
  }
  /// Of the cube against the hand.
  double speed_in_hand() const {
    const HandTrack& track = live_.simulation().state().hands[0];
    const Vector3 hand = (track.current.palm.position - track.previous.palm.position) * kRate;
    return (twist("object").linear - hand).norm();
  }

  std::vector<EventKind> kinds;

 private:
  Scene scene() const {
    Scene scene = pinch_.scene();
    scene.bodies.insert(scene.bodies.begin(), ball_at({0.3, 0, 0}, "first", {0, 0.1, 0}));
    scene.bodies.push_back(ball_at({-0.3, 0, 0}, "last", {0, 0, -0.1}));
    return scene;
  }

  testing::PinchScene pinch_;
  LiveSimulation live_;
  long frame_ = 0;
};

void expect_same(const BodyState& a, const BodyState& b) {
  EXPECT_EQ(a.pose.position, b.pose.position);
  EXPECT_EQ(a.pose.orientation.coeffs(), b.pose.orientation.coeffs());
  EXPECT_EQ(a.linear_momentum, b.linear_momentum);
  EXPECT_EQ(a.angular_momentum, b.angular_momentum);
}

TEST(LiveSimulation, what_is_not_changed_keeps_its_bits_when_an_object_comes_or_goes) {
  Held held;
  held.play(0.7);
  const BodyState cube = held.state("object"), last = held.state("last");
  const std::vector<Contact> contacts = held.contacts_with("object");
  ASSERT_TRUE(held.holds());
  ASSERT_FALSE(contacts.empty());
  held.live().add(ball_at({0, 0.4, 0}, "new"));
  held.live().remove("first");
  expect_same(held.state("object"), cube);
  expect_same(held.state("last"), last);
  EXPECT_TRUE(held.holds());
  const std::vector<Contact> after = held.contacts_with("object");
  ASSERT_EQ(after.size(), contacts.size());
  for (std::size_t i = 0; i < after.size(); ++i) {
    EXPECT_EQ(after[i].key.capsule, contacts[i].key.capsule);
    EXPECT_EQ(after[i].god_object, contacts[i].god_object);
    EXPECT_EQ(after[i].friction, contacts[i].friction);
  }
}

TEST(LiveSimulation, an_object_that_is_never_to_be_grasped_from_now_on_is_let_go) {
  Held held;
  held.play(0.7);
  ASSERT_TRUE(held.holds());
  EXPECT_EQ(held.live().parameter("grasp/object"), "");
  held.live().set_parameters({{"grasp/object", "never"}});
  EXPECT_EQ(held.live().parameter("grasp/object"), "never");
  held.play(1.2);
  EXPECT_FALSE(held.holds());
  EXPECT_EQ(held.live().simulation().scene().bodies[held.index("first")].grasp, GraspMode::parameter);
  EXPECT_THROW(held.live().set_parameters({{"grasp/object", "maybe"}}), ParameterError);
  EXPECT_THROW(held.live().set_parameters({{"grasp/nothing", "never"}}), ParameterError);
  EXPECT_THROW(held.live().parameter("grasp/nothing"), ParameterError);
}

TEST(LiveSimulation, goes_on_after_a_far_body_is_gone_as_if_it_had_never_been) {
  Held changed, unchanged;
  changed.play(0.6), unchanged.play(0.6);
  changed.live().remove("first");
  changed.play(1.5), unchanged.play(1.5);
  expect_same(changed.state("object"), unchanged.state("object"));
  expect_same(changed.state("last"), unchanged.state("last"));
}

TEST(LiveSimulation, a_new_object_is_where_it_was_asked_for_and_takes_part) {
  Held held;
  held.play(0.5);
  held.live().add(ball_at({0, 0.4, 0}, "new", {0.2, 0, 0}));
  EXPECT_EQ(held.state("new").pose.position, Vector3(0, 0.4, 0));
  held.play(1.0);
  EXPECT_NEAR(held.state("new").pose.position.x(), 0.2 * 0.5, 1e-12);
}

TEST(LiveSimulation, an_object_that_comes_into_the_hand_is_not_pushed_until_the_hand_has_left_it) {
  Scene scene;
  LiveSimulation live(scene, testing::unfiltered(ContactModelKind::implicit));
  const auto tip = [](double x) { return testing::finger({x, -0.1, 0}, {x, 0, 0}, 0.008); };
  for (int i = 0; i < 5; ++i) live.simulation().advance({at(i / kRate), {tip(0.0)}});
  live.add(ball_at({0.005, 0, 0}, "ball"));
  for (int i = 5; i < 60; ++i) live.simulation().advance({at(i / kRate), {tip(0.0)}});
  EXPECT_EQ(live.simulation().state().bodies[0].linear_momentum, Vector3(0, 0, 0));
  for (int i = 60; i < 80; ++i) live.simulation().advance({at(i / kRate), {tip(-0.002 * (i - 59))}});
  EXPECT_EQ(live.simulation().state().bodies[0].linear_momentum, Vector3(0, 0, 0));
  for (int i = 80; i < 120; ++i) live.simulation().advance({at(i / kRate), {tip(-0.042 + 0.002 * (i - 79))}});
  EXPECT_GT(live.simulation().state().bodies[0].linear_momentum.x(), 0.0);
}

TEST(LiveSimulation, what_is_held_and_deleted_is_let_go_in_the_order_of_events) {
  Held held;
  held.play(0.7);
  ASSERT_TRUE(held.holds());
  const std::size_t cube = held.index("object");
  const std::vector<Event> events = held.live().events_if_removed("object");
  EXPECT_TRUE(held.holds());
  held.live().remove("object");
  ASSERT_EQ(events.size(), 3u);
  EXPECT_EQ(events[0].kind, EventKind::grasp_end);
  EXPECT_EQ(events[1].kind, EventKind::contact_end);
  EXPECT_EQ(events[2].kind, EventKind::hover_end);
  EXPECT_EQ(events[0].body, static_cast<int>(cube));
  EXPECT_EQ(events[0].hand_id, 1u);
  EXPECT_TRUE(held.simulation().state().contacts.empty());
  for (const Contact& contact : held.simulation().result().contacts) EXPECT_LT(contact.key.body, 2);
  held.play(0.8);
  held.live().remove("first");
  held.live().remove("last");
  held.play(0.9);
  EXPECT_TRUE(held.simulation().state().bodies.empty());
}

/// Of the joint of that name.
double place_of(const char* joint, const LiveSimulation& live) {
  const std::optional<int> found = find_joint(live.simulation().scene(), joint);
  return live.simulation().state().joints.at(static_cast<std::size_t>(found.value())).position;
}

TEST(LiveSimulation, what_is_deleted_takes_along_what_hangs_on_it_and_nothing_else) {
  LiveSimulation live(load_scene("config/scenes/hatch.urdf", {}),
                      testing::unfiltered(ContactModelKind::implicit));
  live.simulation().advance_without_hands(200'000'000);
  const double pressed = place_of("button_2_slide", live);
  live.remove("latch_top");
  EXPECT_FALSE(find_body(live.simulation().scene(), "latch_top"));
  EXPECT_FALSE(find_joint(live.simulation().scene(), "latch_top_axle"));
  EXPECT_EQ(live.simulation().scene().joints.size(), 5u);
  EXPECT_EQ(place_of("button_2_slide", live), pressed);
  for (const Joint& joint : live.simulation().scene().joints)
    EXPECT_EQ(live.simulation().scene().bodies[static_cast<std::size_t>(joint.parent)].name, "wall")
        << joint.name;
  live.simulation().advance_without_hands(400'000'000);
  live.remove("wall");
  EXPECT_TRUE(live.simulation().scene().bodies.empty());
  EXPECT_TRUE(live.simulation().scene().joints.empty());
  live.simulation().advance_without_hands(600'000'000);
}

TEST(LiveSimulation, no_change_by_eye_drops_what_is_held_or_jolts_it) {
  const std::vector<std::pair<std::string, std::string>> changes{
      {"material/stiffness", "4000"},      {"material/stiffness", "1000"},
      {"material/static_friction", "1"},   {"material/dynamic_friction", "0.5"},
      {"material/restitution", "0"},       {"step", "0.004"},
      {"gravity", "[0, 0, -1.0]"},         {"contact_model", "soft_pad"},
      {"contact_model", "virtual_spring"}, {"contact_model", "penetration"}};
  for (const auto& change : changes) {
    SCOPED_TRACE(change.first + " " + change.second);
    Held held;
    held.play(0.7);
    ASSERT_TRUE(held.holds());
    const Twist before = held.twist("object");
    held.live().set_parameters({change});
    EXPECT_EQ(held.twist("object").linear, before.linear);
    EXPECT_EQ(held.twist("object").angular, before.angular);
    double fastest = 0.0;
    for (int i = 1; i <= 60; ++i) {
      held.play(0.7 + i / kRate);
      fastest = std::max(fastest, held.speed_in_hand());
    }
    EXPECT_TRUE(held.holds());
    EXPECT_EQ(std::count(held.kinds.begin(), held.kinds.end(), EventKind::grasp_end), 0);
    // The hand swings at up to 0.3 m/s; on softer springs, soft_pad's a quarter as stiff, the cube sways in
    // it.
    EXPECT_LT(fastest, 0.05);
  }
}

TEST(LiveSimulation, changes_with_every_frame_drop_and_jolt_nothing) {
  Held held;
  held.play(0.7);
  ASSERT_TRUE(held.holds());
  for (int i = 1; i <= 240; ++i) {
    held.live().set_parameters({{"material/static_friction", i % 2 ? "0.9" : "0.8"},
                                {"filter/window", std::to_string(1 + i % 5)},
                                {"tracking/max_speed", std::to_string(20 + i % 3)}});
    held.play(0.7 + i / kRate);
    ASSERT_LT(held.speed_in_hand(), 0.05) << i;
  }
  EXPECT_TRUE(held.holds());
  EXPECT_EQ(std::count(held.kinds.begin(), held.kinds.end(), EventKind::grasp_end), 0);
}

TEST(LiveSimulation, another_filter_takes_over_without_a_jolt) {
  const std::vector<std::vector<std::pair<std::string, std::string>>> changes{
      {{"filter/window", "12"}},
      {{"filter/window", "1"}},
      {{"filter/type", "none"}},
      {{"filter/type", "one_euro"}},
      {{"filter/type", "constant_velocity"}}};
  for (const auto& change : changes) {
    SCOPED_TRACE(change[0].second);
    Configuration configuration = testing::unfiltered(ContactModelKind::implicit);
    configuration.filter.type = FilterKind::window;
    configuration.filter.window = 6;
    Held held(configuration);
    held.play(0.75);
    held.live().set_parameters(change);
    double fastest_change = 0.0;
    for (int i = 1; i <= 60; ++i) {
      const Vector3 before = held.twist("object").linear;
      held.play(0.75 + i / kRate);
      fastest_change = std::max(fastest_change, (held.twist("object").linear - before).norm());
    }
    EXPECT_TRUE(held.holds());
    EXPECT_EQ(std::count(held.kinds.begin(), held.kinds.end(), EventKind::grasp_end), 0);
    // The swing itself changes by 0.017 m/s a frame. Without a transition 25 ms of lag at 0.3 m/s would be a
    // step of 8 mm within a frame: 1 m/s.
    EXPECT_LT(fastest_change, 0.06);
  }
}

TEST(LiveSimulation, a_bad_value_is_refused_and_nothing_changes_nor_does_what_was_set_with_it) {
  Held held;
  held.play(0.7);
  const std::uint64_t before = hash(held.simulation().state());
  const Simulation* simulation = &held.simulation();
  EXPECT_THROW(held.live().set_parameters({{"step", "0.002"}, {"step", "-1"}}), ParameterError);
  EXPECT_THROW(held.live().set_parameters({{"step", "0.002"}, {"speed", "1"}}), ParameterError);
  EXPECT_THROW(held.live().set_parameters({{"material/dynamic_friction", "0.9"}}), ParameterError);
  EXPECT_THROW(held.live().remove("nobody"), std::invalid_argument);
  EXPECT_THROW(held.live().add(ball_at({0, 0.4, 0}, "last")), std::invalid_argument);
  EXPECT_THROW(held.live().add(ball_at({0, 9, 0}, "new")), std::invalid_argument);
  EXPECT_THROW(held.live().add(ball_at({0, 0, 0.03}, "new")), std::invalid_argument);
  EXPECT_THROW(held.live().place("last", {{9, 0, 0}, Quaternion::Identity()}), std::invalid_argument);
  EXPECT_EQ(hash(held.simulation().state()), before);
  EXPECT_EQ(&held.simulation(), simulation);
  EXPECT_EQ(held.simulation().configuration().step, Configuration().step);
}

TEST(LiveSimulation, only_bodies_without_a_material_of_their_own_follow_the_parameters) {
  Scene scene = testing::scene_of(ball_at({0, 0, 0}, "follows"));
  scene.bodies.push_back(ball_at({0, 1, 0}, "own"));
  scene.bodies.back().material.static_friction = 0.9;
  scene.bodies.back().own_material.static_friction = true;
  LiveSimulation live(scene, testing::unfiltered(ContactModelKind::implicit));
  live.set_parameters({{"material/static_friction", "0.7"}, {"material/restitution", "0.1"}});
  EXPECT_EQ(live.simulation().scene().bodies[0].material.static_friction, 0.7);
  EXPECT_EQ(live.simulation().scene().bodies[1].material.static_friction, 0.9);
  EXPECT_EQ(live.simulation().scene().bodies[1].material.restitution, 0.1);
  live.set_parameters({{"contact_model", "seed"}});
  EXPECT_EQ(live.simulation().scene().bodies[0].material.stiffness, 100.0);
}

TEST(LiveSimulation, a_material_that_does_not_go_with_a_bodys_own_numbers_is_refused_with_its_name) {
  Scene scene = testing::scene_of(ball_at({0, 0, 0}, "slick"));
  scene.bodies[0].material.dynamic_friction = 0.4;
  scene.bodies[0].own_material.dynamic_friction = true;
  LiveSimulation live(scene, testing::unfiltered(ContactModelKind::implicit));
  try {
    live.set_parameters({{"material/static_friction", "0.3"}, {"material/dynamic_friction", "0.2"}});
    FAIL() << "the body's dynamic friction would be above its static friction";
  } catch (const ParameterError& error) {
    const std::string said = error.what();
    EXPECT_NE(said.find("'slick'"), std::string::npos) << said;
    EXPECT_NE(said.find("0.4"), std::string::npos) << said;
  }
  EXPECT_EQ(live.simulation().scene().bodies[0].material.static_friction,
            scene.bodies[0].material.static_friction);
}

TEST(LiveSimulation, a_placed_body_is_at_rest_there_and_a_reset_brings_all_that_there_are_to_their_start) {
  Held held;
  held.play(0.7);
  held.live().place("last", {{0, 0.5, 0}, Quaternion::Identity()});
  held.play(1.0);
  EXPECT_EQ(held.state("last").pose.position, Vector3(0, 0.5, 0));
  EXPECT_EQ(held.twist("last").linear, Vector3(0, 0, 0));
  held.live().add(ball_at({0, 0.4, 0}, "new", {0.2, 0, 0}));
  held.live().remove("first");
  held.play(1.2);
  held.simulation().reset();
  EXPECT_EQ(held.state("last").pose.position, Vector3(-0.3, 0, 0));
  EXPECT_EQ(held.state("new").pose.position, Vector3(0, 0.4, 0));
  EXPECT_FALSE(find_body(held.simulation().scene(), "first"));
}

TEST(LiveSimulation, a_reset_into_what_was_spawned_there_is_refused_and_changes_nothing) {
  LiveSimulation live(testing::scene_of(ball_at({0, 0, 0}, "drifts", {0.3, 0, 0})),
                      testing::unfiltered(ContactModelKind::implicit));
  for (int i = 0; i < 120; ++i) live.simulation().advance({at(i / kRate), {}});
  live.add(ball_at({0, 0.01, 0}, "new"));
  const std::uint64_t before = hash(live.simulation().state());
  try {
    live.reset();
    FAIL() << "two balls would be in each other";
  } catch (const std::invalid_argument& error) {
    const std::string said = error.what();
    EXPECT_NE(said.find("'new' is 0.03 m in 'drifts'; allowed: places that are free"), std::string::npos)
        << said;
  }
  EXPECT_EQ(hash(live.simulation().state()), before);
  live.remove("new");
  live.reset();
  EXPECT_EQ(live.simulation().state().bodies[0].pose.position, Vector3(0, 0, 0));
}

/// As a recording of a stranger may ask for it.
TEST(LiveSimulation, a_pose_that_is_none_is_refused) {
  Held held;
  const auto place = [&](double w, double x) {
    held.live().place("last", {{0, 0.5, 0}, Quaternion(w, x, 0, 0)});
  };
  EXPECT_THROW(place(0.0, 0.0), std::invalid_argument);
  EXPECT_THROW(place(std::nan(""), 0.0), std::invalid_argument);
  EXPECT_THROW(place(3.0, 0.0), std::invalid_argument);
  place(0.999, 0.0);
  EXPECT_NEAR(held.simulation().state().bodies.back().pose.orientation.norm(), 1.0, 1e-15);
}

/// A stack that stands goes on standing: contacts between bodies come along.
TEST(LiveSimulation, a_stack_keeps_standing_when_something_else_goes) {
  Scene scene;
  scene.gravity = {0, 0, -9.81};
  scene.bodies = {ball_at({0.5, 0, 0.02}, "away"), testing::box_body({0.3, 0.3, 0.02}, 1.0)};
  scene.bodies[1].name = "table", scene.bodies[1].fixed = true;
  scene.bodies[1].start.position.z() = -0.01;
  for (const char* name : {"lower", "upper"}) {
    scene.bodies.push_back(testing::box_body({0.05, 0.05, 0.05}, 0.1));
    scene.bodies.back().name = name;
    scene.bodies.back().start.position.z() = name[0] == 'l' ? 0.025 : 0.075;
  }
  Configuration configuration = testing::unfiltered(ContactModelKind::implicit);
  configuration.contact.sleep = false;  // a change wakes what lies still, which then lies as still otherwise
  LiveSimulation changed(scene, configuration), unchanged(scene, configuration);
  for (int i = 0; i < 120; ++i) {
    if (i == 60) changed.remove("away");
    changed.simulation().advance({at(i / kRate), {}}), unchanged.simulation().advance({at(i / kRate), {}});
  }
  expect_same(changed.simulation().state().bodies[1], unchanged.simulation().state().bodies[2]);
  expect_same(changed.simulation().state().bodies[2], unchanged.simulation().state().bodies[3]);
  EXPECT_NEAR(changed.simulation().state().bodies[2].pose.position.z(), 0.075, 1e-3);
}

TEST(LiveSimulation, what_hangs_on_a_joint_is_not_placed_and_the_joint_is_named) {
  const Scene scene = load_scene(find_scene_file("hatch", {"config/scenes"}), {});
  LiveSimulation live(scene, Configuration());
  ASSERT_FALSE(scene.joints.empty());
  const Joint& joint = scene.joints.front();
  const std::string name = scene.bodies[static_cast<std::size_t>(joint.child)].name;
  const auto before = hash(live.simulation().state());
  try {
    live.place(name, Pose());
    FAIL() << "placed";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("'" + name + "'"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("'" + joint.name + "'"), std::string::npos) << error.what();
  }
  EXPECT_EQ(hash(live.simulation().state()), before);
}

TEST(Simulation, each_stage_and_each_reason_for_leaving_a_frame_out_has_a_name_of_its_own) {
  std::set<std::string> names;
  for (const Stage stage :
       {Stage::neighbours, Stage::hand_contacts, Stage::body_contacts, Stage::response, Stage::flight})
    names.insert(to_string(stage));
  EXPECT_EQ(names.size(), 5u);
  for (const Rejection rejection :
       {Rejection::none, Rejection::stamp_not_increasing, Rejection::stamp_ahead, Rejection::no_stamp})
    names.insert(to_string(rejection));
  EXPECT_EQ(names.size(), 9u);
}

}  // namespace
}  // namespace mrhi
