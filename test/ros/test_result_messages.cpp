#include <gtest/gtest.h>

#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/stamp_check.h"
#include "mr_hand_interaction/synthetic/random.h"
#include "ros/result_messages.h"
#include "support/joints.h"
#include "support/pinched_cube.h"

/// What the messages' definitions promise, of a hand that holds a cube against a little gravity.
namespace mrhi {
namespace {

using Message = mr_hand_interaction::Contact;

constexpr double kRounding = 1e-12;
const Vector3 kGravity(0, 0, -0.2);  // every model holds against it

std_msgs::Header world() {
  std_msgs::Header header;
  header.frame_id = "world";
  header.stamp = ros::Time(12, 34);
  return header;
}
Vector3 vector(const geometry_msgs::Vector3& v) {
  return {v.x, v.y, v.z};
}
Vector3 vector(const geometry_msgs::Point& p) {
  return {p.x, p.y, p.z};
}

class ResultMessages : public ::testing::TestWithParam<ContactModelKind> {
 protected:
  ResultMessages() : pinched_(GetParam(), kGravity) { pinched_.hold(0.3); }

  const Simulation& simulation() const { return pinched_.simulation(); }
  Outcome outcome() const { return {simulation().scene(), simulation().result(), simulation().state()}; }
  mr_hand_interaction::ContactArray contacts() const { return contacts_message(outcome(), world()); }

  testing::PinchedCube pinched_;
};

TEST_P(ResultMessages, a_contact_splits_its_force_into_push_and_friction) {
  const auto message = contacts();
  EXPECT_EQ(message.header.frame_id, "world");
  ASSERT_EQ(message.contacts.size(), simulation().result().contacts.size());
  ASSERT_GE(message.contacts.size(), 5u);
  int pressed = 0;
  for (const Message& contact : message.contacts) {
    const Vector3 n = vector(contact.normal), force = vector(contact.force);
    EXPECT_NEAR(n.norm(), 1.0, 1e-9);
    EXPECT_NEAR(contact.normal_force, -n.dot(force), kRounding);
    EXPECT_NEAR(contact.tangential_force, (force - n.dot(force) * n).norm(), kRounding);
    const Material& material = pinched_.body().material;
    const double coefficient =
        contact.phase == Message::SLIPPING ? material.dynamic_friction : material.static_friction;
    EXPECT_NEAR(contact.friction_limit, coefficient * std::max(0.0, contact.normal_force), 1e-9);
    EXPECT_GE(contact.normal_force, -kRounding) << "nothing sticks";
    if (contact.normal_force > 0.01) ++pressed;
  }
  EXPECT_GE(pressed, 2);
}

TEST_P(ResultMessages, a_contact_is_told_by_its_object_hand_and_phalanx) {
  for (const Message& contact : contacts().contacts) {
    EXPECT_EQ(contact.object, "object");
    EXPECT_EQ(contact.hand_id, 1u);
    EXPECT_LT(contact.finger, 5);
    EXPECT_EQ(contact.bone, mr_hand_interaction::Phalanx::DISTAL);
    // The thumb is on the side of -x: the normal points from the object to it, and it pushes the other way.
    const double side = contact.finger == mr_hand_interaction::Phalanx::THUMB ? -1.0 : 1.0;
    EXPECT_GT(side * contact.normal.x, 0.99);
    if (contact.normal_force > 0.01) {
      EXPECT_LT(side * contact.force.x, 0.0);
    }
    // On the cube's surface, which is 25 mm from its centre.
    const Vector3 on_cube = pinched_.cube().pose.to_local(vector(contact.position));
    EXPECT_NEAR(side * on_cube.x(), 0.025, 1e-6);
  }
}

TEST_P(ResultMessages, the_wrench_is_the_sum_of_the_forces_about_the_centre_of_mass) {
  const geometry_msgs::Wrench wrench = wrench_message(0, simulation().result(), simulation().state());
  Vector3 force = Vector3::Zero(), torque = Vector3::Zero();
  for (const Message& contact : contacts().contacts) {
    force += vector(contact.force);
    torque += (vector(contact.position) - pinched_.cube().pose.position).cross(vector(contact.force));
  }
  EXPECT_LT((vector(wrench.force) - force).norm(), kRounding);
  EXPECT_LT((vector(wrench.torque) - torque).norm(), kRounding);
  EXPECT_EQ(vector(wrench_message(1, simulation().result(), simulation().state()).force), Vector3::Zero());
}

TEST_P(ResultMessages, phalanges_that_touch_are_marked_in_the_rendered_hand_alone) {
  const auto rendered = rendered_message(outcome(), world());
  const auto tracked = tracked_message(outcome(), world());
  ASSERT_EQ(rendered.hands.size(), 1u);
  ASSERT_EQ(tracked.hands.size(), 1u);
  EXPECT_EQ(rendered.hands[0].id, tracked.hands[0].id);
  int touching = 0;
  for (const auto& phalanx : rendered.hands[0].phalanges) {
    touching += phalanx.touching;
    if (phalanx.touching) {
      EXPECT_EQ(phalanx.bone, mr_hand_interaction::Phalanx::DISTAL);
    }
  }
  EXPECT_GE(touching, 2);
  for (const auto& phalanx : tracked.hands[0].phalanges) EXPECT_FALSE(phalanx.touching);
}

INSTANTIATE_TEST_SUITE_P(, ResultMessages,
                         ::testing::Values(ContactModelKind::implicit, ContactModelKind::seed,
                                           ContactModelKind::penetration, ContactModelKind::virtual_spring,
                                           ContactModelKind::soft_pad),
                         [](const auto& model) { return std::string(model.param.name); });

/// A free body whose link's frame is not at its centre of mass, a fixture, and two that hang on a joint.
struct Things {
  Things() {
    Body free = testing::box_body({0.05, 0.05, 0.05}, 0.2), shelf = free;
    free.name = "free", shelf.name = "shelf", shelf.fixed = true;
    free.link_in_body.position = {0.01, 0.02, 0.03};
    scene = testing::pendulum(2, 0.3, 9.81);
    scene.bodies.push_back(free);
    scene.bodies.push_back(shelf);
    for (Body& body : scene.bodies) complete(body);
    arrange_joints(scene);
    for (const Body& body : scene.bodies) state.bodies.push_back(start_state(body));
    state.joints.resize(scene.joints.size());
    state.hands.resize(kMaxHands);
    state.interactions.resize(scene.bodies.size() * kMaxHands);
    state.bodies[2].pose = {{1, 2, 3}, Quaternion(Eigen::AngleAxisd(M_PI / 2, Vector3::UnitZ()))};
    state.bodies[2].linear_momentum = {0.2, 0, 0};
  }
  Scene scene;
  SimulationState state;
};

TEST(ObjectMessages, tell_pose_twist_and_mass_of_what_is_no_fixture) {
  Things things;
  things.state.interactions[2].level = InteractionLevel::grasp;
  const auto message = objects_message({things.scene, FrameResult(), things.state}, world());
  ASSERT_EQ(message.objects.size(), 3u);
  EXPECT_EQ(message.objects[0].name, "rod_0");
  const auto& object = message.objects[2];
  EXPECT_EQ(object.name, "free");
  EXPECT_EQ(vector(object.pose.position), Vector3(1, 2, 3));
  EXPECT_NEAR(object.pose.orientation.z, std::sqrt(0.5), kRounding);
  EXPECT_LT((vector(object.twist.linear) - Vector3(1, 0, 0)).norm(), kRounding);  // 0.2 N s of 0.2 kg
  EXPECT_EQ(object.mass, 0.2);
  EXPECT_TRUE(object.held);
  EXPECT_FALSE(message.objects[0].held);
}

TEST(ObjectMessages, say_that_grasp_assist_supports_an_object_and_with_which_wrench) {
  const Things things;
  FrameResult result;
  result.assists = {{0, 2, {0, 0, 0.75}, {0.25, 0, 0}}, {1, 2, {0, 0.5, 0}, {0.5, 0, 0}}};  // of two hands
  const auto objects = objects_message({things.scene, result, things.state}, world()).objects;
  EXPECT_TRUE(objects[2].assisted);
  EXPECT_EQ(vector(objects[2].assist_force), Vector3(0, 0.5, 0.75));
  EXPECT_EQ(vector(objects[2].assist_torque), Vector3(0.75, 0, 0));
  EXPECT_FALSE(objects[0].assisted);
  EXPECT_EQ(vector(objects[0].assist_force), Vector3(0, 0, 0));
}

TEST(SceneMessages, are_in_the_frame_and_of_the_time_that_they_are_made_for) {
  const auto message = scene_message(Things().scene, {}, world());
  EXPECT_EQ(message.header.frame_id, "world");
  EXPECT_EQ(message.header.stamp, ros::Time(12, 34));
}

TEST(ObjectMessages, a_transform_is_of_the_link_and_fixtures_have_one) {
  const Things things;
  const auto transforms = object_transforms(things.scene, things.state, world());
  ASSERT_EQ(transforms.size(), 4u);
  EXPECT_EQ(transforms[2].child_frame_id, "free");
  EXPECT_EQ(transforms[3].child_frame_id, "shelf");
  EXPECT_EQ(transforms[2].header.frame_id, "world");
  // A quarter turn about z takes the link's offset (0.01, 0.02, 0.03) to (-0.02, 0.01, 0.03).
  EXPECT_LT((vector(transforms[2].transform.translation) - Vector3(0.98, 2.01, 3.03)).norm(), kRounding);
  EXPECT_NEAR(transforms[2].transform.rotation.w, std::sqrt(0.5), kRounding);
}

TEST(ObjectMessages, what_is_held_is_told_in_the_scenes_order) {
  Things things;
  EXPECT_EQ(held_objects(things.scene, things.state), "");
  things.state.interactions[2].level = InteractionLevel::grasp;
  EXPECT_EQ(held_objects(things.scene, things.state), "free");
  things.state.interactions[0].level = InteractionLevel::grasp;
  things.state.interactions[1].level = InteractionLevel::contact;
  EXPECT_EQ(held_objects(things.scene, things.state), "rod_0,free");
}

// Half of what presses: of a pinch, what either finger does.
TEST(GripForce, is_half_of_what_presses_on_the_named_bodies) {
  mr_hand_interaction::ContactArray message;
  const auto add = [&](const char* object, double nx, double fx, double fy) {
    message.contacts.emplace_back();
    message.contacts.back().object = object;
    message.contacts.back().normal.x = nx;
    message.contacts.back().force.x = fx;
    message.contacts.back().force.y = fy;
  };
  add("cube", 1.0, -3.0, 1.0);
  add("cube", -1.0, 5.0, -1.0);
  add("cube", 1.0, 2.0, 0.0);  // pulls
  add("table", 1.0, -7.0, 0.0);
  EXPECT_DOUBLE_EQ(grip_force(message, {"cube"}), 4.0);
  EXPECT_DOUBLE_EQ(grip_force(message, {"cube", "table"}), 7.5);
  EXPECT_EQ(grip_force(message, {}), 0.0);
}

TEST(EventMessages, name_the_object_and_the_hand_or_neither) {
  const Things things;
  Event event{5, EventKind::grasp_begin, 2, 7};
  const auto grasp = event_message(things.scene, FrameResult(), event, world());
  EXPECT_EQ(grasp.kind, grasp.GRASP_BEGIN);
  EXPECT_EQ(grasp.object, "free");
  EXPECT_EQ(grasp.hand_id, 7u);
  const auto lost = event_message(things.scene, FrameResult(), {5, EventKind::hand_lost, -1, 7}, world());
  EXPECT_EQ(lost.kind, lost.HAND_LOST);
  EXPECT_EQ(lost.object, "");
}

TEST(EventMessages, every_kind_has_the_messages_number) {
  using M = mr_hand_interaction::InteractionEvent;
  const std::pair<EventKind, int> kinds[] = {{EventKind::hover_begin, M::HOVER_BEGIN},
                                             {EventKind::hover_end, M::HOVER_END},
                                             {EventKind::contact_begin, M::CONTACT_BEGIN},
                                             {EventKind::contact_end, M::CONTACT_END},
                                             {EventKind::grasp_begin, M::GRASP_BEGIN},
                                             {EventKind::grasp_end, M::GRASP_END},
                                             {EventKind::hand_lost, M::HAND_LOST},
                                             {EventKind::hand_found, M::HAND_FOUND},
                                             {EventKind::out_of_bounds, M::OUT_OF_BOUNDS},
                                             {EventKind::joint_limit, M::JOINT_LIMIT},
                                             {EventKind::detent, M::DETENT},
                                             {EventKind::latch_open, M::LATCH_OPEN}};
  for (const auto& [kind, number] : kinds)
    EXPECT_EQ(event_message(Things().scene, FrameResult(), {0, kind, -1, 0}, world()).kind, number);
}

TEST(PoseArray, has_twenty_one_joints_from_the_wrist_to_the_little_fingers_tip) {
  testing::PinchedCube pinched(ContactModelKind::implicit);
  pinched.hold(0.1);
  Hand hand = pinched.simulation().result().rendered.at(0).hand;
  hand.wrist = {0, 0, -0.2};
  hand.capsules[capsule_index(2, 3)].radius = 0.0;  // not seen
  const geometry_msgs::PoseArray message = pose_array_message(hand, world());
  ASSERT_EQ(message.poses.size(), 21u);
  EXPECT_EQ(vector(message.poses[0].position), hand.wrist);
  for (int finger = 0; finger < kFingers; ++finger) {
    const std::size_t first = 1 + 4 * std::size_t(finger);
    const auto bone = [&](int which) { return hand.capsules[std::size_t(capsule_index(finger, which))]; };
    EXPECT_EQ(vector(message.poses[first].position), bone(1).start);
    EXPECT_EQ(vector(message.poses[first + 1].position), bone(1).end);
    EXPECT_EQ(vector(message.poses[first + 2].position), bone(2).end);
    if (finger == 2) {
      EXPECT_TRUE(std::isnan(message.poses[first + 3].position.x));
    } else {
      EXPECT_EQ(vector(message.poses[first + 3].position), bone(3).end);
      // x points to the tip.
      const Vector3 x = from_message(message.poses[first + 3]).orientation * Vector3::UnitX();
      EXPECT_LT((x - (bone(3).end - bone(3).start).normalized()).norm(), 1e-9);
    }
  }
}

TEST(Conversion, of_a_pose_there_and_back_gives_the_same_bits) {
  Random random(1);
  for (int i = 0; i < 50; ++i) {
    const Pose pose{random.gaussian_vector(1.0),
                    Quaternion(random.gaussian(), random.gaussian(), random.gaussian(), random.gaussian())};
    const Pose back = from_message(to_message(pose));
    EXPECT_EQ(back.position, pose.position);
    EXPECT_EQ(back.orientation.coeffs(), pose.orientation.coeffs());
  }
}

TEST(Conversion, of_a_transform_gives_a_unit_quaternion) {
  geometry_msgs::Transform transform;
  transform.translation.y = 2.0;
  transform.rotation.w = 1.0, transform.rotation.x = 1.0;
  const Pose pose = from_message(transform);
  EXPECT_EQ(pose.position, Vector3(0, 2, 0));
  EXPECT_NEAR(pose.orientation.norm(), 1.0, kRounding);
  EXPECT_NEAR(pose.orientation.x(), std::sqrt(0.5), kRounding);
}

TEST(Conversion, of_stamps_keeps_nanoseconds_and_stays_within_what_ros_has) {
  for (const Nanoseconds stamp : {Nanoseconds(0), Nanoseconds(1), Nanoseconds(1'234'567'890'123'456'789)})
    EXPECT_EQ(from_ros_time(to_ros_time(stamp)), stamp);
  EXPECT_EQ(from_ros_time(to_ros_time(-5)), 0);
  EXPECT_EQ(from_ros_time(to_ros_time(StampCheck::kLatest)), StampCheck::kLatest);
  EXPECT_EQ(from_ros_time(to_ros_time(std::numeric_limits<Nanoseconds>::max())), StampCheck::kLatest);
}

TEST(Requests, to_spawn_are_taken_word_for_word) {
  mr_hand_interaction::SpawnObject::Request message;
  message.name = "n", message.urdf = "u", message.shape = "box", message.material = "m";
  message.size = {1.0, 2.0, 3.0};
  message.mass = 0.5;
  message.pose.position.x = 0.1;
  message.pose.orientation.z = 1.0;
  message.twist.linear.y = 0.2;
  message.twist.angular.z = 0.3;
  message.color.r = 0.25f, message.color.a = 0.5f;
  const ObjectRequest request = from_message(message);
  EXPECT_EQ(request.name + request.urdf + request.shape + request.material, "nuboxm");
  EXPECT_EQ(request.size, (std::vector<double>{1.0, 2.0, 3.0}));
  EXPECT_EQ(request.mass, 0.5);
  EXPECT_EQ(request.pose.position, Vector3(0.1, 0, 0));
  EXPECT_EQ(request.pose.orientation.z(), 1.0);
  EXPECT_EQ(request.twist.linear, Vector3(0, 0.2, 0));
  EXPECT_EQ(request.twist.angular, Vector3(0, 0, 0.3));
  ASSERT_TRUE(request.rgba);
  EXPECT_EQ(*request.rgba, (std::array<float, 4>{{0.25f, 0, 0, 0.5f}}));
  EXPECT_FALSE(request.whole);
}

TEST(Requests, an_orientation_and_a_colour_of_zeros_are_none) {
  EXPECT_EQ(from_message(mr_hand_interaction::SpawnObject::Request()).pose.orientation.w(), 1.0);
  EXPECT_FALSE(from_message(mr_hand_interaction::SpawnObject::Request()).rgba);
  mr_hand_interaction::SpawnUrdf::Request whole;
  whole.joints = "j", whole.urdf = "u", whole.name = "n";
  const ObjectRequest request = from_message(whole);
  EXPECT_TRUE(request.whole);
  EXPECT_EQ(request.pose.orientation.w(), 1.0);
  EXPECT_EQ(request.name + request.urdf + request.joints, "nuj");
}

TEST(JointMessages, tell_what_moves_a_pendulum) {
  Things things;
  things.state.joints[1].position = 0.4;
  things.state.joints[1].effort = -0.2;
  // The first rod turns about its upper end: the joint's velocity is its spin about y.
  const double spin = 2.0;
  const Body& rod = things.scene.bodies[0];
  const Pose& pose = things.state.bodies[0].pose;
  const Vector3 w(0, spin, 0), arm = pose.position - Vector3(0, 0, 0.5);
  things.state.bodies[0].angular_momentum =
      pose.orientation * (rod.inertia * (pose.orientation.conjugate() * w));
  things.state.bodies[0].linear_momentum = rod.mass * w.cross(arm);
  const sensor_msgs::JointState message =
      joint_states_message({things.scene, FrameResult(), things.state}, world());
  EXPECT_EQ(message.header, world());
  ASSERT_EQ(message.name.size(), 2u);
  EXPECT_EQ(message.name[1], "joint_1");
  EXPECT_EQ(message.position[1], 0.4);
  EXPECT_EQ(message.effort[1], -0.2);
  EXPECT_NEAR(message.velocity[0], spin, 1e-9);
  EXPECT_NEAR(message.velocity[1], -spin, 1e-9);  // the second hangs still on what turns
}

// A pendulum let go from 0.3 rad: its velocity is the change of its place, from frame to frame.
TEST(JointStates, tell_names_places_and_velocities_in_the_scenes_order) {
  Simulation simulation(testing::pendulum(2, 0.3, 9.81), Configuration());
  const auto at = [&](int milliseconds) {
    simulation.advance({testing::at(1e-3 * milliseconds), {}});
    return joint_states_message({simulation.scene(), simulation.result(), simulation.state()}, {});
  };
  const auto first = at(0);
  ASSERT_EQ(first.name, (std::vector<std::string>{"joint_0", "joint_1"}));
  EXPECT_NEAR(first.position[0], 0.3, 1e-9);
  EXPECT_NEAR(first.velocity[0], 0.0, 1e-9);
  for (int t = 1; t < 100; ++t) at(t);
  const auto before = at(100), now = at(101), after = at(102);
  for (const std::size_t joint : {0, 1}) {
    const double by_place = (after.position[joint] - before.position[joint]) / 0.002;
    EXPECT_NEAR(now.velocity[joint], by_place, 1e-4)
        << joint;  // the second difference: 1e-3 s squared times the jerk
  }
  EXPECT_LT(now.velocity[0], -0.1);
}

}  // namespace
}  // namespace mrhi
