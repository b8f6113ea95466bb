#include <gtest/gtest.h>

#include "mr_hand_interaction/response/contact_model.h"
#include "support/pinched_cube.h"

namespace mrhi {
namespace {

using testing::at;
using testing::box_body;

const Pill kPill{0.02, 0.04};

Body pill_body(const Vector3& position, const Quaternion& orientation) {
  Body body = box_body(Vector3(0.04, 0.04, 0.12), 0.2);
  body.shapes = {{kPill, {}}};
  complete(body);
  body.start.position = position, body.start.orientation = orientation;
  return body;
}

/// At 1 g on a table from x = -0.5 to 0.5, whose top is at z = 0.
Pose after(double seconds, Body body) {
  Body table = box_body(Vector3(1.0, 1.0, 0.1), 1.0);
  table.name = "table";
  table.fixed = true;
  table.start.position = Vector3(0, 0, -0.05);
  Scene scene;
  scene.name = "table";
  scene.bodies = {table, std::move(body)};
  scene.gravity = Vector3(0, 0, -9.81);
  Configuration configuration = testing::unfiltered(ContactModelKind::implicit);
  configuration.contact.sleep = false;  // the law itself is tried here
  configuration.gravity = scene.gravity;
  Simulation simulation(scene, configuration);
  simulation.advance({at(0.0), {}});
  for (long i = 1; i <= std::lround(100.0 * seconds); ++i) simulation.advance({at(0.01 * double(i)), {}});
  return simulation.state().bodies[1].pose;
}

Quaternion along_x() {
  return Quaternion(Eigen::AngleAxisd(0.5 * 3.141592653589793, Vector3::UnitY()));
}

TEST(Capsules, one_that_lies_on_a_table_stays) {
  // Whole, and a third beyond the edge: its middle is 27 mm from it.
  for (const double x : {0.0, 0.473}) {
    SCOPED_TRACE(x);
    const Body pill = pill_body(Vector3(x, 0, 0.02), along_x());
    const Pose settled = after(1.0, pill), later = after(21.0, pill);
    EXPECT_NEAR(settled.position.z(), 0.02, 2e-5);
    EXPECT_LT((later.position - settled.position).norm(), 1e-6);
    EXPECT_LT(later.orientation.angularDistance(settled.orientation), 1e-5);
  }
}

TEST(Capsules, one_that_hangs_over_by_more_than_half_falls) {
  EXPECT_LT(after(1.0, pill_body(Vector3(0.52, 0, 0.02), along_x())).position.z(), -0.1);
}

TEST(Capsules, one_that_leans_falls_over_and_comes_to_lie) {
  const Quaternion leaning(Eigen::AngleAxisd(0.3, Vector3(1, 2, 0).normalized()));
  const Pose lies = after(4.0, pill_body(Vector3(0, 0, 0.02 + 0.04 * std::cos(0.3)), leaning));
  EXPECT_NEAR(lies.position.z(), 0.02, 1e-4);
  EXPECT_NEAR((lies.orientation * Vector3::UnitZ()).z(), 0.0, 1e-3);
}

/// Scene (a) with another shape in place of the cube, as wide: carried to and fro for 3 s.
std::vector<Pose> held(const Shape& shape) {
  testing::PinchScene pinch;
  pinch.stiffness = default_material(testing::unfiltered(ContactModelKind::implicit)).stiffness;
  Scene scene = pinch.scene();
  scene.bodies[0].shapes = {{shape, {}}};
  complete(scene.bodies[0]);
  Simulation simulation(scene,
                        testing::PinchedCube::configuration_of(ContactModelKind::implicit, Vector3::Zero()));
  std::vector<Pose> poses;
  for (int i = 0; i <= 3000; ++i) {
    const double t = 0.001 * i;
    const Vector3 sway = t < 0.5 ? Vector3(Vector3::Zero()) : testing::swing(t - 0.5, 0.1, 1.0);
    simulation.advance({at(t), {pinch.hand(t, sway)}});
    if (i % 100 == 0) poses.push_back(simulation.state().bodies[0].pose);
  }
  return poses;
}

// Fingers touch its straight side alone.
TEST(Capsules, one_is_held_as_a_cylinder_of_its_side_is) {
  const std::vector<Pose> cylinder = held(Cylinder{0.025, 0.04}), pill = held(Pill{0.025, 0.04});
  for (std::size_t i = 0; i < cylinder.size(); ++i) {
    EXPECT_LT((pill[i].position - cylinder[i].position).norm(), 1e-9) << i;
    EXPECT_LT(pill[i].orientation.angularDistance(cylinder[i].orientation), 1e-7) << i;
  }
}

}  // namespace
}  // namespace mrhi
