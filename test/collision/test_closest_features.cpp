#include <gtest/gtest.h>

#include "brute_force.h"
#include "collision/closest_features.h"
#include "placed_shapes.h"

namespace mrhi {
namespace {

constexpr double kAnyDistance = 1.0;  // [m]
const Sphere kSphere{0.03};
const Box kBox{{0.03, 0.02, 0.01}};
const Cylinder kCylinder{0.02, 0.03};

ClosestFeatures closest(const Capsule& capsule, const Shape& shape) {
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return capsule_sphere(capsule, *sphere);
  if (const auto* box = std::get_if<Box>(&shape)) return capsule_box(capsule, *box);
  return std::get<Cylinder>(shape).closest(capsule, kAnyDistance);
}
const Shape kShapes[] = {kSphere, kBox, kCylinder};

void expect_near(const Vector3& a, const Vector3& b, double tolerance = kRounding) {
  EXPECT_LT((a - b).norm(), tolerance) << a.transpose() << " against " << b.transpose();
}

TEST(ClosestFeatures, finger_along_a_face_touches_in_the_middle_of_the_stretch) {
  for (const double z : {0.017, 0.004}) {  // outside, and with the axis inside
    const Capsule over_edge{{0.01, 0.005, z}, {0.05, 0.005, z}, 0.008};
    const ClosestFeatures features = capsule_box(over_edge, kBox);
    expect_near(features.point, {0.02, 0.005, 0.01});
    expect_near(features.normal, Vector3::UnitZ());
    EXPECT_NEAR(features.axis_parameter, 0.25, kRounding);
    EXPECT_NEAR(features.distance, z - 0.01 - 0.008, kRounding);
  }
  const Capsule on_cap{{-0.05, 0.012, 0.037}, {0, 0.012, 0.037}, 0.008};
  expect_near(kCylinder.closest(on_cap, kAnyDistance).point, {-0.008, 0.012, 0.03});
  const Capsule beside{{0.027, 0, 0.01}, {0.027, 0, 0.09}, 0.008};
  expect_near(kCylinder.closest(beside, kAnyDistance).point, {0.02, 0, 0.02});
  const Capsule inside{{0.017, 0, 0.01}, {0.017, 0, 0.09}, 0.008};
  expect_near(kCylinder.closest(inside, kAnyDistance).point, {0.02, 0, 0.02});
}

TEST(ClosestFeatures, rounding_of_a_parallel_finger_does_not_move_its_middle) {
  for (const double tilt : {0.0, 1e-16, -1e-15, 1e-14}) {
    const ClosestFeatures features = capsule_box({{0, 0, 0.017}, {0.02, tilt, 0.017 + tilt}, 0.008}, kBox);
    EXPECT_NEAR(features.axis_parameter, 0.5, 1e-9) << tilt;
  }
}

TEST(ClosestFeatures, axis_through_the_middle_leaves_by_a_fixed_side) {
  for (const Shape& shape : kShapes) {
    for (int i = 0; i < 3; ++i) {
      const Capsule capsule = capsule_about(Vector3::Zero(), 0.02 * Vector3::Unit(i), 0.008);
      const ClosestFeatures first = closest(capsule, shape), again = closest(capsule, shape);
      EXPECT_NEAR(first.normal.norm(), 1.0, kRounding);
      EXPECT_EQ(first.normal, again.normal);
      expect_near(first.point + (first.distance + 0.008) * first.normal,
                  capsule.axis_point(first.axis_parameter));
    }
  }
  const ClosestFeatures through = capsule_sphere({{-0.01, 0, 0}, {0.02, 0, 0}, 0.008}, kSphere);
  EXPECT_NEAR(through.normal.x(), 0.0, kRounding);
  EXPECT_NEAR(through.distance, -0.038, kRounding);
  const ClosestFeatures pierced = kCylinder.closest({{0, 0, -0.1}, {0, 0, 0.1}, 0.008}, kAnyDistance);
  EXPECT_NEAR(pierced.normal.z(), 0.0, kRounding);
  EXPECT_NEAR(pierced.distance, -0.028, kRounding);
}

TEST(ClosestFeatures, capsule_without_length_is_a_ball) {
  const Vector3 places[] = {
      {0.05, 0.01, 0}, {0.05, 0.04, 0.02}, {0.001, 0.002, 0.008}, {0.019, 0.001, 0.002}};
  for (const Shape& shape : kShapes) {
    for (const Vector3& place : places) {
      const ClosestFeatures ball = closest({place, place, 0.005}, shape);
      const ClosestFeatures bead = closest({place, place, 0.0}, shape);
      EXPECT_NEAR(ball.distance, bead.distance - 0.005, kRounding);
      expect_near(ball.point + (ball.distance + 0.005) * ball.normal, place);
      const AxisSpan span = contact_span({place, place, 0.005}, shape, ball);
      EXPECT_EQ(span.s0, span.s1);
    }
  }
}

TEST(ClosestFeatures, mirrored_capsules_have_mirrored_features) {
  Random random(8);
  for (int i = 0; i < 20000 && !HasFailure(); ++i) {
    const Capsule capsule = capsule_about(random.in_box({0.05, 0.05, 0.05}),
                                          random.between(0.01, 0.05) * random.direction(), 0.008);
    const Vector3 mirror(random.sign(), random.sign(), random.sign());
    const Capsule other{capsule.end.cwiseProduct(mirror), capsule.start.cwiseProduct(mirror), 0.008};
    for (const Shape& shape : kShapes) {
      const ClosestFeatures a = closest(capsule, shape), b = closest(other, shape);
      EXPECT_NEAR(a.distance, b.distance, kRounding);
      if (std::abs(a.distance + 0.008) < 1e-6) continue;  // directions of gaps of rounding's size
      expect_near(a.normal.cwiseProduct(mirror), b.normal, 1e-8);
      expect_near(a.point.cwiseProduct(mirror), b.point, 1e-8);
      EXPECT_NEAR(a.axis_parameter, 1.0 - b.axis_parameter, 1e-6);
    }
  }
}

TEST(ClosestFeatures, distance_changes_by_no_more_than_the_capsule_moves) {
  Random random(9);
  for (int i = 0; i < 20000 && !HasFailure(); ++i) {
    const Capsule from = capsule_about(random.in_box({0.04, 0.04, 0.04}),
                                       random.between(0.0, 0.05) * random.direction(), 0.008);
    Capsule to = from;
    const double way = std::pow(10.0, random.between(-9, -3));
    to.start += way * random.direction();
    to.end += way * random.direction();
    for (const Shape& shape : kShapes) {
      const double change = closest(to, shape).distance - closest(from, shape).distance;
      EXPECT_LE(std::abs(change), way + 2e-11);  // an axis that lies on the surface counts as inside
    }
  }
}

TEST(ClosestFeatures, gap_vector_changes_by_no_more_than_the_capsule_is_shifted) {
  Random random(10);
  for (int i = 0; i < 20000 && !HasFailure(); ++i) {
    const Capsule from = capsule_about(random.in_box({0.06, 0.06, 0.06}), 0.03 * random.direction(), 0.008);
    const Vector3 shift = 1e-7 * random.direction();
    const Capsule to{from.start + shift, from.end + shift, from.radius};
    for (const Shape& shape : kShapes) {
      const ClosestFeatures a = closest(from, shape), b = closest(to, shape);
      if (a.distance < -0.007) continue;  // the axis is nearer than 1 mm, or inside
      // The gap leads from a point to its projection onto a convex set, and projections do not stretch.
      const double gap = a.distance + 0.008;
      EXPECT_LE((gap * a.normal - (b.distance + 0.008) * b.normal).norm(), 1e-7 + 2e-11);
    }
  }
}

TEST(ContactSpan, is_the_part_over_the_face) {
  const Capsule capsule{{0.01, 0.005, 0.017}, {0.05, 0.005, 0.018}, 0.008};
  const AxisSpan span = contact_span(capsule, kBox, capsule_box(capsule, kBox));
  EXPECT_NEAR(span.s0, 0.0, kRounding);
  EXPECT_NEAR(span.s1, 0.5, kRounding);
  const Capsule on_cap{{-0.05, 0.012, 0.037}, {0, 0.012, 0.037}, 0.008};
  const AxisSpan disc = contact_span(on_cap, kCylinder, kCylinder.closest(on_cap, kAnyDistance));
  EXPECT_NEAR(disc.s0, (0.05 - 0.016) / 0.05, kRounding);
  EXPECT_NEAR(disc.s1, 1.0, kRounding);
}

TEST(ContactSpan, along_a_cylinder_shrinks_to_a_point_while_the_finger_turns_across) {
  double before = 1.0;
  for (const double angle : {0.0, 0.03, 0.07, 0.12, 1.5}) {
    const Vector3 along = 0.04 * Vector3(0, std::sin(angle), std::cos(angle));
    const Capsule capsule = capsule_about({0.027, 0, 0}, along, 0.008);
    const AxisSpan span = contact_span(capsule, kCylinder, kCylinder.closest(capsule, kAnyDistance));
    const double length = span.s1 - span.s0;
    EXPECT_NEAR(length, std::max(0.0, 1.0 - std::sin(angle) / 0.3), 1e-9);
    EXPECT_LE(length, before);
    before = length;
  }
}

TEST(ContactSpan, edges_vertices_rims_and_spheres_are_touched_at_a_point) {
  const Capsule over_edge{{0.02, 0, 0.025}, {0.05, 0, 0.006}, 0.008};
  const Capsule over_vertex{{0.05, 0.035, 0.02}, {0.07, 0.06, 0.05}, 0.008};
  const Capsule over_rim{{0, 0, 0.055}, {0.04, 0, 0.02}, 0.008};
  for (const auto& pair :
       {std::make_pair(over_edge, Shape(kBox)), std::make_pair(over_vertex, Shape(kBox)),
        std::make_pair(over_rim, Shape(kCylinder)), std::make_pair(over_edge, Shape(kSphere))}) {
    const ClosestFeatures features = closest(pair.first, pair.second);
    const AxisSpan span = contact_span(pair.first, pair.second, features);
    EXPECT_EQ(span.s0, features.axis_parameter);
    EXPECT_EQ(span.s1, features.axis_parameter);
  }
}

TEST(ContactSpan, holds_the_closest_point) {
  Random random(11);
  for (int i = 0; i < 20000 && !HasFailure(); ++i) {
    const Capsule capsule =
        capsule_about(random.in_box({0.05, 0.05, 0.05}), 0.03 * random.direction(), 0.008);
    for (const Shape& shape : kShapes) {
      const ClosestFeatures features = closest(capsule, shape);
      const AxisSpan span = contact_span(capsule, shape, features);
      EXPECT_LE(0.0, span.s0);
      EXPECT_LE(span.s0, features.axis_parameter);
      EXPECT_LE(features.axis_parameter, span.s1);
      EXPECT_LE(span.s1, 1.0);
    }
  }
}

TEST(Shape, bounding_radius_holds_every_corner) {
  auto triangles = std::make_shared<TriangleMesh>();
  triangles->vertices = {
      {0.1, 0, 0}, {0, 0.3, 0.4}, {0, 0, 0}, {9, 9, 9}};  // the last belongs to no triangle
  triangles->triangles = {{{0, 1, 2}}};
  EXPECT_DOUBLE_EQ(bounding_radius(Sphere{0.2}), 0.2);
  EXPECT_DOUBLE_EQ(bounding_radius(Box{{0.02, 0.03, 0.06}}), 0.07);
  EXPECT_DOUBLE_EQ(bounding_radius(Cylinder{0.03, 0.04}), 0.05);
  EXPECT_DOUBLE_EQ(bounding_radius(Mesh{triangles, "", Vector3::Ones()}), 0.5);
}

constexpr double kExact = 1e-12;

TEST(Exit, is_the_distance_to_the_far_side_along_the_line) {
  const Shape box = Box{Vector3(0.1, 0.2, 0.3)};
  EXPECT_NEAR(exit_distance(box, Vector3(0.02, 0.1, 0), Vector3::UnitX()).value(), 0.08, kExact);
  EXPECT_NEAR(exit_distance(box, Vector3(-0.5, 0.1, 0), Vector3::UnitX()).value(), 0.6, kExact);
  const Vector3 diagonal = Vector3(1, 1, 0).normalized();
  EXPECT_NEAR(exit_distance(box, Vector3(0.05, 0, 0), diagonal).value(), 0.05 * std::sqrt(2.0), kExact);
  const Shape sphere = Sphere{0.05};
  EXPECT_NEAR(exit_distance(sphere, Vector3(0, 0.03, 0.01), Vector3::UnitZ()).value(), 0.03, kExact);
  const Shape cylinder = Cylinder{0.05, 0.1};
  EXPECT_NEAR(exit_distance(cylinder, Vector3(0, 0.03, 0.02), Vector3::UnitZ()).value(), 0.08, kExact);
  EXPECT_NEAR(exit_distance(cylinder, Vector3(0, 0.03, 0.02), Vector3::UnitX()).value(), 0.04, kExact);
}

TEST(Exit, is_negative_where_the_shape_lies_behind) {
  EXPECT_NEAR(exit_distance(Box{Vector3(0.1, 0.1, 0.1)}, Vector3(0, 0, 0.12), Vector3::UnitZ()).value(),
              -0.02, kExact);
  EXPECT_NEAR(exit_distance(Sphere{0.05}, Vector3(0, 0, 0.06), Vector3::UnitZ()).value(), -0.01, kExact);
}

TEST(Exit, is_nothing_where_the_line_misses) {
  EXPECT_FALSE(exit_distance(Box{Vector3(0.1, 0.1, 0.1)}, Vector3(0.11, 0, 0), Vector3::UnitZ()));
  EXPECT_FALSE(exit_distance(Box{Vector3(0.1, 0.1, 0.1)}, Vector3(0.3, 0, 0), Vector3(1, 1, 0).normalized()));
  EXPECT_FALSE(exit_distance(Sphere{0.05}, Vector3(0, 0.051, 0), Vector3::UnitZ()));
  EXPECT_FALSE(exit_distance(Cylinder{0.05, 0.1}, Vector3(0.06, 0, 0), Vector3::UnitZ()));
  EXPECT_FALSE(exit_distance(Cylinder{0.05, 0.1}, Vector3(0, 0, 0.11), Vector3::UnitX()));
  EXPECT_FALSE(exit_distance(Mesh{}, Vector3::Zero(), Vector3::UnitX()));
}

TEST(Exit, a_line_along_a_side_still_meets_the_shape) {
  EXPECT_TRUE(exit_distance(Box{Vector3(0.1, 0.1, 0.1)}, Vector3(0.1 + 1e-15, 0, 0), Vector3(1e-17, 0, 1)));
  EXPECT_TRUE(exit_distance(Cylinder{0.05, 0.1}, Vector3(0.05 + 1e-15, 0, 0), Vector3(0, 1e-17, 1)));
}

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
