#include <gtest/gtest.h>

#include "collision/contact_finder.h"
#include "response/impact.h"
#include "support/fixtures.h"

namespace mrhi {
namespace {

constexpr double kRadius = 0.008;
constexpr std::size_t kTip = capsule_index(1, 3);

/// A plate or cube at the origin and one fingertip, moved by hand from step to step.
class GodObject : public ::testing::Test {
 protected:
  void make(const Vector3& size) {
    scene_ = testing::scene_of(testing::box_body(size, 0.1));
    bodies_ = {start_state(scene_.bodies[0])};
    geometry_ = std::make_unique<SceneGeometry>(scene_);
    neighbours_ = std::make_unique<Neighbours>(scene_);
    finder_ = std::make_unique<ContactFinder>(scene_, *geometry_, Vector3::Zero());
  }
  void move_to(const Vector3& start, const Vector3& end) {
    std::vector<HandTrack> tracks(kMaxHands);
    tracks[0].active = true;
    tracks[0].current.capsules[kTip] = {start, end, kRadius};
    tracks[0].previous = tracks[0].current;
    neighbours_->begin_frame(tracks, bodies_);
    neighbours_->begin_step(bodies_, 0.001);
    finder_->find({HandMotion(tracks[0], 0, 0.0)}, *neighbours_, bodies_, 0.001, contacts_);
  }
  /// A fingertip that stands on its tip, `depth` below the top face, `x` along it.
  void poke(double depth, double x = 0.0) {
    const double z = 0.5 * size_z() + kRadius - depth;
    move_to(Vector3(x, 0, z + 0.02), Vector3(x, 0, z));
  }
  double size_z() const { return 2.0 * std::get<Box>(scene_.bodies[0].shapes[0].shape).half_extents.z(); }

  Scene scene_;
  std::vector<BodyState> bodies_;
  std::unique_ptr<SceneGeometry> geometry_;
  std::unique_ptr<Neighbours> neighbours_;
  std::unique_ptr<ContactFinder> finder_;
  std::vector<Contact> contacts_;
};

TEST_F(GodObject, is_where_the_fingertip_entered_and_on_the_surface) {
  make(Vector3::Constant(0.05));
  poke(-0.0001, 0.004);
  poke(0.003, 0.004);
  ASSERT_EQ(contacts_.size(), 1u);
  EXPECT_NEAR(contacts_[0].depth, 0.003, 1e-12);
  EXPECT_LE((contacts_[0].point - Vector3(0.004, 0, 0.025)).norm(), 1e-9);
  EXPECT_LE((contacts_[0].normal - Vector3::UnitZ()).norm(), 1e-9);
  EXPECT_LE((contacts_[0].hand_point - Vector3(0.004, 0, 0.022)).norm(), 1e-9);
}

TEST_F(GodObject, stays_behind_while_the_fingertip_moves_along_the_face) {
  make(Vector3::Constant(0.05));
  poke(-0.0001);
  poke(0.002);
  for (int i = 1; i <= 10; ++i) poke(0.002, 0.0001 * i);
  EXPECT_LE((contacts_[0].point - Vector3(0, 0, 0.025)).norm(), 1e-9);
  EXPECT_NEAR(contacts_[0].hand_point.x(), 0.001, 1e-12);
}

TEST_F(GodObject, keeps_the_face_that_it_entered_by_through_a_thin_plate) {
  make(Vector3(0.1, 0.1, 0.010));
  for (int i = 0; i <= 40; ++i) {
    const double depth = -0.0005 + 0.0004 * i;
    poke(depth);
    if (depth <= 0.0) continue;
    ASSERT_EQ(contacts_.size(), 1u) << depth;
    EXPECT_LE((contacts_[0].normal - Vector3::UnitZ()).norm(), 1e-9) << depth;
    EXPECT_NEAR(contacts_[0].depth, depth, 1e-9);
  }
}

TEST_F(GodObject, forgets_once_the_surfaces_have_come_apart) {
  make(Vector3::Constant(0.05));
  poke(-0.0001);
  poke(0.002);
  poke(-2.0 * kSeparation, 0.006);
  poke(0.002, 0.006);
  EXPECT_NEAR(contacts_[0].point.x(), 0.006, 1e-9);
}

TEST_F(GodObject, moves_with_its_body) {
  make(Vector3::Constant(0.05));
  poke(-0.0001);
  poke(0.002);
  bodies_[0].pose.position += Vector3(0.0005, 0.0003, 0);
  poke(0.002);
  EXPECT_LE((contacts_[0].point - Vector3(0.0005, 0.0003, 0.025)).norm(), 1e-9);
}

TEST_F(GodObject, a_phalanx_along_a_face_has_two_that_share_its_stiffness_by_the_lever_rule) {
  make(Vector3::Constant(0.05));
  const double z = 0.025 + kRadius;
  move_to(Vector3(-0.01, 0, z + 0.0001), Vector3(0.01, 0, z + 0.0001));
  move_to(Vector3(-0.01, 0, z - 0.002), Vector3(0.01, 0, z - 0.002));
  ASSERT_EQ(contacts_.size(), 2u);
  EXPECT_NEAR(contacts_[0].share, 0.5, 1e-9);
  move_to(Vector3(-0.01, 0, z - 0.003), Vector3(0.01, 0, z - 0.001));
  ASSERT_EQ(contacts_.size(), 2u);
  EXPECT_NEAR(contacts_[0].share, 0.75, 1e-9);
  EXPECT_NEAR(contacts_[0].share + contacts_[1].share, 1.0, 1e-15);
}

TEST(ContactVelocity, of_an_objects_point_is_that_of_its_centre_plus_spin_cross_arm) {
  const Twist twist{Vector3(1, 2, 3), Vector3(0, 0, 2)};
  EXPECT_EQ(object_velocity(twist, Vector3(1, 0, 0), Vector3(1.5, 0, 0)), Vector3(1, 3, 3));
}

TEST(ContactVelocity, of_a_phalanx_is_its_ends_velocity_at_the_ends_and_turns_with_the_bone) {
  MovingHand hand;
  const Vector3 none = Vector3::Zero();
  hand.start[kTip] = {none, Vector3(0, 1, 0), none, none};
  hand.end[kTip] = {Vector3(0.1, 0, 0), Vector3(0, 3, 0), none, none};  // 20 rad/s about z
  hand.radius[kTip] = kRadius;
  hand.rate = PathWeights::between(0.0, 1.0, 1.0);
  const int tip = static_cast<int>(kTip);
  const PhalanxMotion motion = hand.motion(tip, hand.capsule(tip));
  EXPECT_EQ(motion.of_surface(0.0, Vector3::Zero()), Vector3(0, 1, 0));
  EXPECT_EQ(motion.of_surface(1.0, Vector3::Zero()), Vector3(0, 3, 0));
  EXPECT_LE((motion.of_surface(0.5, Vector3(0, 0.01, 0)) - Vector3(-0.2, 2, 0)).norm(), 1e-12);
}

TEST(Classification, follows_the_sign_of_equation_8) {
  EXPECT_EQ(classify(0.1), Approach::separating);
  EXPECT_EQ(classify(0.0), Approach::resting);
  EXPECT_EQ(classify(-0.1), Approach::colliding);
}

TEST(CollisionMatrix, is_symmetric_positive_definite_and_gives_the_points_velocity_change) {
  Body body = testing::box_body(Vector3(0.02, 0.04, 0.2), 0.3);
  BodyState state = start_state(body);
  state.pose.orientation = Quaternion(0.3, 0.5, -0.4, 0.2).normalized();
  const Vector3 r(0.01, -0.03, 0.05), impulse(0.02, -0.01, 0.03);
  const Matrix3 k = collision_matrix(1.0 / body.mass, world_inverse_inertia(body, state.pose.orientation), r);
  EXPECT_LE((k - k.transpose()).norm(), 1e-12 * k.norm());
  EXPECT_GT(k.determinant(), 0.0);
  apply_impulse(impulse, state.pose.position + r, state);
  const Vector3 change = object_velocity(twist_of(body, state), state.pose.position, state.pose.position + r);
  EXPECT_LE((change - k * impulse).norm(), 1e-12);
}

}  // namespace
}  // namespace mrhi
