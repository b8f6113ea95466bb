#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mr_hand_interaction/scene/body.h"
#include "scene/scene_files.h"

namespace mrhi {
namespace {

std::string complaint(Body body) {
  try {
    complete(body);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

Body named(const std::string& name) {
  Body body;
  body.name = name;
  return body;
}

TEST(CompleteBody, InvertsTheInertia) {
  Body body = named("brick");
  body.inertia << 2, 0.1, 0.2, 0.1, 3, -0.3, 0.2, -0.3, 4;
  complete(body);
  EXPECT_LT((body.inertia * body.inverse_inertia - Matrix3::Identity()).norm(), 1e-14);
  EXPECT_EQ(body.inverse_inertia, body.inverse_inertia.transpose());
}

TEST(CompleteBody, BoundsAllShapesAboutTheCentreOfMass) {
  Body body = named("two balls");
  body.shapes = {{Sphere{0.1}, {}}, {Sphere{0.2}, {Vector3(0, 0.3, 0.4), Quaternion::Identity()}}};
  complete(body);
  EXPECT_NEAR(0.7, body.bounding_radius, 1e-15);
}

TEST(CompleteBody, AFixtureNeedsNoMassAndCannotBeTurned) {
  Body body = named("shelf");
  body.fixed = true;
  body.mass = 0;
  body.inertia.setZero();
  complete(body);
  EXPECT_EQ(Matrix3::Zero(), body.inverse_inertia);
}

TEST(CompleteBody, RefusesAMassThatIsNotPositive) {
  for (const double mass : {0.0, -1.0, 1e-300, 1e300, std::numeric_limits<double>::quiet_NaN()}) {
    Body body = named("brick");
    body.mass = mass;
    test::expect_words(complaint(body), {"'brick'", "mass", "from 1e-06 to 1e+06 kg"});
  }
}

TEST(CompleteBody, RefusesAMotionAPlaceAndASizeBeyondTheirLimits) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double number : {1e200, -1e6, nan}) {
    Body body = named("brick");
    body.start_twist.angular.y() = number;
    test::expect_words(complaint(body), {"'brick'", "spin", "0 to 1000 rad/s"});
    body = named("brick");
    body.start_twist.linear.x() = number;
    test::expect_words(complaint(body), {"'brick'", "velocity", "0 to 100 m/s"});
    body = named("brick");
    body.start.position.z() = number;
    test::expect_words(complaint(body), {"'brick'", "place", "-1000 to 1000 m"});
    body = named("brick");
    body.shapes = {{Sphere{std::abs(number)}, {}}};
    test::expect_words(complaint(body), {"'brick'", "shape", "0 to 1000 m"});
    body = named("brick");
    body.inertia *= std::abs(number) * 1e4;
    test::expect_words(complaint(body), {"'brick'", "inertia"});
  }
}

TEST(CompleteBody, RefusesAnInertiaThatIsNotSymmetricPositiveDefinite) {
  Body body = named("brick");
  body.inertia.diagonal() = Vector3(1, 2, -3);
  test::expect_words(complaint(body), {"'brick'", "inertia", "[-3, 1, 2]", "above 0"});
  body.inertia.diagonal() = Vector3(1, 2, 0);
  test::expect_words(complaint(body), {"'brick'", "inertia", "above 0"});
  body.inertia = Matrix3::Identity();
  body.inertia(0, 1) = 0.1;
  test::expect_words(complaint(body), {"'brick'", "inertia", "symmetric"});
  body.inertia(0, 1) = std::numeric_limits<double>::infinity();
  test::expect_words(complaint(body), {"'brick'", "inertia", "finite"});
}

}  // namespace
}  // namespace mrhi
