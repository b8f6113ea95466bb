#include <gtest/gtest.h>

#include "brute_force.h"
#include "collision/closest_features.h"
#include "random_capsules.h"

namespace mrhi {
namespace {

constexpr int kPoses = 100000;
constexpr double kLength = 1e-9;     // of distances, against searches that end at 1e-12 and below [m]
constexpr double kPoint = 1e-6;      // asked for [m]
constexpr double kAngle = 1.745e-4;  // asked for: 0.01 degrees [rad]

/// What the comparisons could decide; a test asks for enough of each.
struct Tally {
  int inside = 0, unique_normals = 0, unique_points = 0, unfinished = 0;
};

/// The answer must hold as a witness, wherever it lies on a flat place: a point of the surface, and the axis
/// point from which `separation` along the normal leads to it.
template <typename ShapeType>
void expect_witness(const Capsule& capsule, const ShapeType& shape, double shape_radius,
                    const ClosestFeatures& features) {
  const double separation = features.distance + capsule.radius;
  const Vector3 core = features.point - shape_radius * features.normal;
  EXPECT_NEAR(features.normal.norm(), 1.0, 1e-12);
  EXPECT_NEAR((shape.nearest(core) - core).norm(), 0.0, 1e-12);
  EXPECT_NEAR(features.normal.dot(shape.farthest(features.normal) - core), 0.0, kLength);
  const Vector3 axis_point = capsule.axis_point(features.axis_parameter);
  EXPECT_NEAR((axis_point - features.point - separation * features.normal).norm(), 0.0, kLength);
  EXPECT_GE(features.axis_parameter, 0.0);
  EXPECT_LE(features.axis_parameter, 1.0);
}

/// The point is unique if from a micrometre to either side on the axis the surface is farther by more than
/// 1e-12 m: farther than the least distance outside, farther after the translation inside.
template <typename ShapeType>
void expect_point(const Capsule& capsule, const ShapeType& shape, double shape_radius, const Vector3& shift,
                  const ClosestFeatures& features, Tally& tally) {
  const auto place = [&](double s) -> Vector3 { return capsule.axis_point(s) + shift; };
  const auto distance = [&](double s) { return (place(s) - shape.nearest(place(s))).norm(); };
  const double s = golden_section(distance), length = (capsule.end - capsule.start).norm();
  const double least = distance(s);
  for (const double step : {-1e-6, 1e-6}) {
    const double aside = s + step / std::max(length, 1e-12);
    if (aside > 0 && aside < 1 && distance(aside) < least + 1e-12) return;
  }
  ++tally.unique_points;
  const Vector3 point = shape.nearest(place(s)) + shape_radius * features.normal;
  EXPECT_LT((features.point - point).norm(), kPoint);
}

/// Outside: the least distance by golden section; its direction is unique, but rounding below 1e-8 m.
/// Inside: LeastTranslation. A sphere is given as a point and a radius about it: there is no inside.
template <typename ShapeType>
void compare(const Capsule& capsule, const ShapeType& shape, double shape_radius,
             const ClosestFeatures& features, Tally& tally) {
  expect_witness(capsule, shape, shape_radius, features);
  const auto gap = [&](double s) -> Vector3 {
    return capsule.axis_point(s) - shape.nearest(capsule.axis_point(s));
  };
  const double s = golden_section([&](double t) { return gap(t).squaredNorm(); });
  double separation = gap(s).norm();
  if (separation > 1e-8) {
    ++tally.unique_normals;
    EXPECT_LT((features.normal - gap(s).normalized()).norm(), kAngle);
    expect_point(capsule, shape, shape_radius, Vector3::Zero(), features, tally);
  } else if (separation < 1e-11 && shape_radius == 0.0) {
    const LeastTranslation<ShapeType> out(capsule, shape);
    ++tally.inside;
    separation = -out.length();
    tally.unfinished += !out.finished();
    if (out.finished() && out.unique()) {
      ++tally.unique_normals;
      EXPECT_LT((features.normal - out.normal()).norm(), kAngle);
      expect_point(capsule, shape, shape_radius, out.length() * features.normal, features, tally);
    }
  }
  EXPECT_NEAR(features.distance, separation - shape_radius - capsule.radius, kLength);
}

/// Capsules in general: anywhere near, deep, along an axis of the shape, with an end on its surface or the
/// axis through its centre, and of no length.
Capsule any_capsule(Random& random, const Vector3& half, int kind) {
  const double radius = random.between(0.005, 0.012);
  Vector3 along = random.between(0.005, 0.06) * random.direction();
  Vector3 middle = random.in_box(1.5 * half + Vector3::Constant(0.02));
  switch (kind) {
    case 0:
      break;
    case 1:
      middle = random.in_box(half);
      break;
    case 2:
      along[random.below(3)] = 0.0;
      break;
    case 3:
      along = along.norm() * Vector3::Unit(random.below(3));
      break;
    case 4: {
      const int i = random.below(3);
      middle = random.in_box(half);
      middle[i] = random.sign() * half[i];
      return {middle, middle + along, radius};
    }
    case 5:
      middle.setZero();
      break;
    default:
      along.setZero();
  }
  return capsule_about(middle, along, radius);
}
constexpr int kKinds = 7;

TEST(ClosedForms, sphere_agrees_with_search) {
  Random random(1);
  Tally tally;
  for (int i = 0; i < kPoses && !HasFailure(); ++i) {
    const Sphere sphere{random.between(0.01, 0.05)};
    const Capsule capsule =
        i % 2 == 0 ? any_capsule(random, Vector3::Constant(sphere.radius), (i / 2) % kKinds) : [&] {
          const Vector3 normal = random.direction();
          return capsule_facing(random, sphere.radius * normal, normal, touching_gap(random));
        }();
    SCOPED_TRACE(i);
    compare(capsule, PointShape{}, sphere.radius, capsule_sphere(capsule, sphere), tally);
  }
  EXPECT_GT(tally.unique_normals, 0.9 * kPoses);
  EXPECT_GT(tally.unique_points, 0.9 * kPoses);
}

/// A point of a box and a normal there: on a face, an edge or at a vertex.
Capsule facing_box(Random& random, const Vector3& half, int dimensions) {
  Vector3 point = random.in_box(half), normal = Vector3::Zero();
  const int first = random.below(3);
  for (int k = 0; k < dimensions; ++k) {
    const int i = (first + k) % 3;
    const double side = random.sign();
    point[i] = side * half[i];
    normal[i] = side * random.between(0.01, 1);
  }
  return capsule_facing(random, point, normal.normalized(), touching_gap(random));
}

TEST(ClosedForms, box_agrees_with_search) {
  Random random(2);
  Tally tally;
  for (int i = 0; i < kPoses && !HasFailure(); ++i) {
    const Vector3 half =
        Vector3(random.between(0.003, 0.05), random.between(0.01, 0.05), random.between(0.01, 0.1));
    const Capsule capsule =
        i % 2 == 0 ? any_capsule(random, half, (i / 2) % kKinds) : facing_box(random, half, 1 + (i / 2) % 3);
    SCOPED_TRACE(i);
    compare(capsule, BoxShape{half}, 0.0, capsule_box(capsule, Box{half}), tally);
  }
  EXPECT_EQ(tally.unfinished, 0);
  EXPECT_GT(tally.inside, 0.2 * kPoses);
  EXPECT_GT(tally.unique_normals, 0.9 * kPoses);
  EXPECT_GT(tally.unique_points, 0.7 * kPoses);
}

/// A point of a cylinder and a normal there: on the side, a cap or a rim.
Capsule facing_cylinder(Random& random, const Cylinder& cylinder, int kind) {
  const double turn = random.between(-3.15, 3.15), side = random.sign();
  const Vector3 radial(std::cos(turn), std::sin(turn), 0);
  Vector3 point = cylinder.radius * radial, normal = radial;
  point.z() = side * cylinder.half_length;
  if (kind == 0) point.z() *= random.between(-1, 1);
  if (kind == 1) point.head<2>() *= random.between(0, 1), normal = side * Vector3::UnitZ();
  if (kind == 2) normal = (radial + side * random.between(0.01, 10) * Vector3::UnitZ()).normalized();
  return capsule_facing(random, point, normal, touching_gap(random));
}

TEST(ClosedForms, cylinder_agrees_with_search) {
  Random random(3);
  Tally tally;
  for (int i = 0; i < kPoses && !HasFailure(); ++i) {
    const Cylinder cylinder{random.between(0.005, 0.05), random.between(0.003, 0.08)};
    const Vector3 half(cylinder.radius, cylinder.radius, cylinder.half_length);
    const Capsule capsule = i % 2 == 0 ? any_capsule(random, half, (i / 2) % kKinds)
                                       : facing_cylinder(random, cylinder, (i / 2) % 3);
    SCOPED_TRACE(i);
    compare(capsule, CylinderShape{cylinder.radius, cylinder.half_length}, 0.0,
            cylinder.closest(capsule, 1.0), tally);
  }
  EXPECT_EQ(tally.unfinished, 0);
  EXPECT_GT(tally.inside, 0.2 * kPoses);
  EXPECT_GT(tally.unique_normals, 0.8 * kPoses);
  EXPECT_GT(tally.unique_points, 0.7 * kPoses);
}

}  // namespace
}  // namespace mrhi
