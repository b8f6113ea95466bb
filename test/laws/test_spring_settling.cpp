// What is left in a contact's memory when a step has been solved: the god object, and whether it sticks.
#include <gtest/gtest.h>

#include <cmath>

#include "response/contact_step.h"
#include "response/penetration_model.h"
#include "response/spring_contact.h"
#include "support/fixtures.h"

namespace mrhi {
namespace {

constexpr double kDepth = 0.002;             // [m]
constexpr double kSpringStiffness = 2000.0;  // [N/m]
constexpr double kStep = 0.001;              // [s]
constexpr double kStatic = 0.8, kDynamic = 0.6;

/// A fingertip on a body that does not move, drawn along x by `stretch` from where it stuck.
class Touch {
 public:
  explicit Touch(double stretch, Friction before = Friction::sticking) {
    Body body = testing::box_body(Vector3::Constant(0.05), 0.1);
    body.material.stiffness = kSpringStiffness;
    body.material.static_friction = kStatic, body.material.dynamic_friction = kDynamic;
    scene_ = testing::scene_of(body);
    complete(scene_.bodies[0]);
    bodies_.push_back(start_state(scene_.bodies[0]));
    contact.depth = kDepth;
    contact.friction = before;
    contact.normal = Vector3::UnitZ();
    contact.hand_point = Vector3(stretch, 0.0, -kDepth);
    contact.patch = 0.004;
  }

  /// As the implicit model does at the velocity 0, without damping.
  void settle_implicit() {
    ContactConfiguration configuration;
    configuration.damping = false;
    configuration.hand = HandStrength();
    ContactStep step{scene_,         gravity_, kStep,    configuration, contacts_,
                     body_contacts_, bodies_,  changes_, grips_};
    make_spring(step, contact, spring);
    spring.spring.evaluate(triple(Vector3::Zero()), 0.0, true, spring.response);
    settle(step, spring, contact);
  }
  void settle_seed() { penetration_force(scene_.bodies[0], bodies_[0], 0.0, 10.0, contact); }

  /// Along the surface, from the god object to the finger [m].
  double stretch_left() const { return contact.hand_point.x() - (bodies_[0].pose * contact.god_object).x(); }

  Contact contact;
  SpringContact spring{};

 private:
  Scene scene_;
  Vector3 gravity_ = Vector3::Zero();
  std::vector<Contact> contacts_;
  std::vector<BodyContact> body_contacts_;
  std::vector<BodyState> bodies_;
  StepChanges changes_;
  std::vector<Grip> grips_;
};

// The spring of a contact that slides keeps what gives Coulomb's force, no more and no less.
TEST(Settling, what_slides_keeps_the_stretch_that_friction_bears) {
  const double borne = kDynamic * kDepth;  // stiffness cancels
  Touch implicit(0.005);
  implicit.settle_implicit();
  EXPECT_EQ(implicit.contact.friction, Friction::slipping);
  EXPECT_NEAR(implicit.stretch_left(), borne, 1e-12);
  Touch seed(0.005);
  seed.settle_seed();
  EXPECT_EQ(seed.contact.friction, Friction::slipping);
  EXPECT_NEAR(seed.stretch_left(), borne, 1e-12);
}

TEST(Settling, what_sticks_keeps_all_of_its_stretch) {
  Touch implicit(0.9 * kStatic * kDepth);
  implicit.settle_implicit();
  EXPECT_EQ(implicit.contact.friction, Friction::sticking);
  EXPECT_NEAR(implicit.stretch_left(), 0.9 * kStatic * kDepth, 1e-12);
}

TEST(Settling, what_slides_sticks_again_where_sliding_would_give_more) {
  for (const double part : {0.99, 1.01}) {
    Touch touch(part * kDynamic * kDepth, Friction::slipping);
    touch.settle_implicit();
    EXPECT_EQ(touch.contact.friction == Friction::sticking, part < 1.0) << part;
  }
}

// The slide is what lies beyond Coulomb's limit of static friction.
TEST(Settling, friction_stays_static_up_to_a_sliding_speed_of_1_cm_a_second) {
  for (const double speed : {0.009, 0.011}) {
    Touch touch(kStatic * kDepth + speed * kStep);
    touch.settle_implicit();
    EXPECT_EQ(touch.contact.friction, speed < 0.01 ? Friction::creeping : Friction::slipping) << speed;
    EXPECT_NEAR(touch.stretch_left(), (speed < 0.01 ? kStatic : kDynamic) * kDepth, 1e-12) << speed;
  }
}

// A patch of radius a that presses evenly bears 2/3 of friction times push times a.
TEST(Settling, a_patch_bears_two_thirds_of_its_radius) {
  Touch touch(0.0);
  touch.contact.twist = 3.0;
  touch.settle_implicit();
  EXPECT_NEAR(touch.spring.response.torque, 2.0 / 3.0 * kStatic * kSpringStiffness * kDepth * 0.004, 1e-12);
}

}  // namespace
}  // namespace mrhi
