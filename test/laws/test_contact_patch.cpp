#include <gtest/gtest.h>

#include "response/contact_patch.h"

namespace mrhi {
namespace {

constexpr double kStep = 0.001, kPatchStiffness = 2000.0;

/// A hand's contact, or a point of a grip, with the one free body.
SpringContact row_of(const Triple& normal) {
  SpringContact row{};
  row.a = SpringContact::kNone, row.b = 0;
  row.arm = {0.01, -0.02, 0.03};
  row.spring.normal = normal;
  row.spring.stiffness = row.spring.shear = kPatchStiffness;
  row.spring.ahead = kStep;
  row.spring.yields = HandStrength::kUnlimited;
  row.spring.stretch = {4e-4, 3e-4, 0.0};
  return row;
}

/// Makes the patch of the row, starts it with `start`, and relaxes it once while nothing moves: returns the
/// largest component by which its impulses change.
template <typename Start>
double change_at_rest(const SpringContact& row, const Start& start) {
  std::vector<PatchBody> bodies{{Motion6::Zero(), 10.0, 1e3 * Matrix3::Identity()},
                                {Motion6::Zero(), 0.0, Matrix3::Zero()}};
  std::vector<PatchPoint> points;
  ContactPatch patch = make_patch(kStep, &row, 1, bodies, points);
  start(patch, points[0], bodies);
  EXPECT_GT(bodies[0].motion.norm(), 0.0) << "the body has the impulses";
  Motion6 motion = Motion6::Zero(), impulse = Motion6::Zero();
  patch.relax(kStep, points.data(), &row.spring, motion, impulse);
  return impulse.cwiseAbs().maxCoeff();
}

TEST(ContactPatch, of_a_hand_starts_from_what_its_springs_hold_at_rest) {
  SpringContact row = row_of({0, 0, 1});
  row.spring.depth = 1e-3;
  row.spring.friction = 0.8;
  for (const double patch_friction : {0.1, 1e-3}) {  // the torque of the spring, or its limit
    row.spring.twist = 0.01;
    row.spring.twist_stiffness = 0.5;
    row.spring.patch_friction = patch_friction;
    const Vector3 force(kPatchStiffness * 4e-4, kPatchStiffness * 3e-4, -kPatchStiffness * 1e-3);
    const double change = change_at_rest(row, [&](const auto& patch, auto& point, auto& bodies) {
      patch.start_from(force, row.spring, kStep, point, bodies[1], bodies[0]);
      EXPECT_NEAR(point.impulses[kTwist], kStep * std::min(0.5 * 0.01, patch_friction * 2.0), 1e-15);
    });
    EXPECT_LT(change, 1e-15) << patch_friction;
  }
}

TEST(ContactPatch, of_a_grip_starts_from_its_stretch_up_to_its_bond) {
  SpringContact row = row_of({0, 0, 0});
  row.spring.stretch.z = -2e-4;
  for (const double bond : {5.0, 0.5}) {
    row.spring.bond = bond;
    const double change = change_at_rest(row, [&](const auto& patch, auto& point, auto& bodies) {
      patch.start_from(Vector3::Zero(), row.spring, kStep, point, bodies[1], bodies[0]);
      const Vector3 stretched = kPatchStiffness * Vector3(4e-4, 3e-4, -2e-4);
      const Vector3 force = point.impulse().x() * patch.axes.row(0) +
                            point.impulse().y() * patch.axes.row(1) + point.impulse().z() * patch.axes.row(2);
      EXPECT_LT((force / kStep - std::min(1.0, bond / stretched.norm()) * stretched).norm(), 1e-12) << bond;
    });
    EXPECT_LT(change, 1e-15) << bond;
  }
}

}  // namespace
}  // namespace mrhi
