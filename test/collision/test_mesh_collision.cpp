#include <gtest/gtest.h>
#include <cmath>
#include <thread>

#include "collision/mesh_collision.h"
#include "mesh_shapes.h"
#include "random_capsules.h"
#include "same_features.h"
#include "support/tessellated.h"

namespace mrhi {
namespace {

constexpr double kFar = 10.0;        // margin that keeps everything [m]
constexpr double kRounding = 1e-12;  // of lengths of some centimetres, over some dozens of operations [m]

/// The angle mesh is the union of these two boxes.
const Vector3 kArmHalf[2] = {{0.03, 0.01, 0.02}, {0.01, 0.03, 0.02}};
const Vector3 kArmCentre[2] = {{0.01, -0.01, 0}, {-0.01, 0.01, 0}};

ClosestFeatures arm(const Capsule& capsule, int i) {
  const Capsule local{capsule.start - kArmCentre[i], capsule.end - kArmCentre[i], capsule.radius};
  ClosestFeatures features = capsule_box(local, Box{kArmHalf[i]});
  features.point += kArmCentre[i];
  return features;
}

TEST(MeshCollision, mesh_of_a_box_is_the_box) {
  Random random(4);
  for (int i = 0; i < 20000 && !HasFailure(); ++i) {
    const Vector3 half(random.between(0.01, 0.04), random.between(0.01, 0.04), random.between(0.01, 0.04));
    const Vector3 along = random.between(0.0, 0.06) * random.direction();
    const Capsule capsule = capsule_about(random.in_box(2 * half), along, random.between(0.005, 0.01));
    const ClosestFeatures box = capsule_box(capsule, Box{half});
    const MeshCollider collider(box_mesh(half));
    const auto mesh = collider.closest(capsule, kFar);
    SCOPED_TRACE(i);
    ASSERT_TRUE(mesh);
    EXPECT_NEAR(mesh->distance, box.distance, kRounding);
    // Conditioning: the direction of a gap is known to rounding / gap, the place of a crossing likewise.
    if (std::abs(box.distance + capsule.radius) < 1e-5) continue;
    EXPECT_LT((mesh->normal - box.normal).norm(), 1e-8);
    EXPECT_LT((mesh->point - box.point).norm(), 1e-7);
    EXPECT_NEAR(mesh->axis_parameter, box.axis_parameter, 1e-5);
  }
}

TEST(MeshCollision, capsule_along_a_face_touches_in_the_middle_of_the_stretch) {
  const MeshCollider collider(box_mesh({0.03, 0.02, 0.01}));
  for (const double gap : {0.001, -0.002, -0.009}) {  // the last with the axis inside
    const double z = 0.01 + 0.008 + gap;
    const auto features = collider.closest({{-0.01, 0.013, z}, {0.05, 0.013, z}, 0.008}, 0.002);
    ASSERT_TRUE(features);
    EXPECT_NEAR(features->distance, gap, kRounding);
    EXPECT_LT((features->point - Vector3(0.01, 0.013, 0.01)).norm(), kRounding);
    EXPECT_LT((features->normal - Vector3::UnitZ()).norm(), kRounding);
  }
}

// As pieces of a convex decomposition overlap: outside, through them and inside the solid is their union.
TEST(MeshCollision, mesh_of_parts_is_as_far_as_the_nearer_and_as_deep_as_the_deeper_of_them) {
  TriangleMesh both;
  for (int i = 0; i < 2; ++i) {
    const TriangleMesh box = box_mesh(kArmHalf[i]);
    const int first = static_cast<int>(both.vertices.size());
    both.parts.push_back(static_cast<int>(both.triangles.size()));
    for (const Vector3& vertex : box.vertices) both.vertices.push_back(vertex + kArmCentre[i]);
    for (const auto& t : box.triangles)
      both.triangles.push_back({{t[0] + first, t[1] + first, t[2] + first}});
  }
  const MeshCollider collider(both);
  Random random(9);
  int inside = 0;
  for (int i = 0; i < 50000 && !HasFailure(); ++i) {
    const Vector3 along = random.between(0.0, 0.05) * random.direction();
    const Capsule capsule =
        capsule_about(random.in_box({0.06, 0.06, 0.04}), along, random.between(0.0, 0.01));
    const double expected = std::min(arm(capsule, 0).distance, arm(capsule, 1).distance);
    SCOPED_TRACE(i);
    for (const double margin : {0.0, 0.005, kFar}) {
      const auto features = collider.closest(capsule, margin);
      if (std::abs(expected - margin) < kRounding) continue;
      ASSERT_EQ(features.has_value(), expected < margin) << expected;
      if (features) {
        EXPECT_NEAR(features->distance, expected, kRounding);
      }
    }
    inside += expected < -capsule.radius ? 1 : 0;
  }
  EXPECT_GT(inside, 5000);
}

TEST(MeshCollision, hollow_solid_is_as_far_as_the_nearer_of_its_parts) {
  Random random(5);
  const MeshCollider collider(angle_mesh());
  int outside = 0;
  for (int i = 0; i < 50000 && !HasFailure(); ++i) {
    const Vector3 along = random.between(0.0, 0.04) * random.direction();
    const Capsule capsule = capsule_about(random.in_box({0.06, 0.06, 0.04}), along, 0.008);
    const ClosestFeatures a = arm(capsule, 0), b = arm(capsule, 1);
    const ClosestFeatures& nearer = a.distance < b.distance ? a : b;
    const double gap = nearer.distance + capsule.radius;
    if (gap < 1e-5) continue;
    ++outside;
    SCOPED_TRACE(i);
    const auto mesh = collider.closest(capsule, kFar);
    ASSERT_EQ(bool(mesh), true);
    EXPECT_NEAR(mesh->distance, nearer.distance, kRounding);
    if (std::abs(a.distance - b.distance) < 1e-9) continue;  // either part may be named
    EXPECT_LT((mesh->normal - nearer.normal).norm(), 1e-8);
    EXPECT_LT((mesh->point - nearer.point).norm(), 1e-7);
  }
  EXPECT_GT(outside, 10000);
}

/// Distance from the surface of the angle: of its eight faces, each a flat box (the caps are two each).
double distance_from_surface(const Vector3& place) {
  const auto to_box = [&](const Vector3& min, const Vector3& max) {
    return (place - place.cwiseMax(min).cwiseMin(max)).norm();
  };
  const double a = 0.02, b = 0.04, h = 0.02;
  double least = std::min({to_box({-a, -a, -h}, {b, -a, h}), to_box({b, -a, -h}, {b, 0, h}),
                           to_box({0, 0, -h}, {b, 0, h}), to_box({0, 0, -h}, {0, b, h}),
                           to_box({-a, b, -h}, {0, b, h}), to_box({-a, -a, -h}, {-a, b, h})});
  for (const double z : {-h, h}) {
    least = std::min({least, to_box({-a, -a, z}, {b, 0, z}), to_box({-a, -a, z}, {0, b, z})});
  }
  return least;
}

TEST(MeshCollision, balls_in_a_hollow_solid_leave_by_the_nearest_surface) {
  Random random(6);
  const MeshCollider collider(angle_mesh());
  for (int i = 0; i < 20000 && !HasFailure(); ++i) {
    const Vector3 place = random.in_box({0.045, 0.045, 0.025});
    const Capsule ball{place, place, 0.004};
    const bool inside = arm(ball, 0).distance < -ball.radius || arm(ball, 1).distance < -ball.radius;
    const auto features = collider.closest(ball, kFar);
    SCOPED_TRACE(i);
    ASSERT_TRUE(features);
    const double distance = distance_from_surface(place);
    EXPECT_NEAR(features->distance, (inside ? -distance : distance) - ball.radius, kRounding);
    EXPECT_NEAR((features->point - place + (features->distance + ball.radius) * features->normal).norm(), 0,
                kRounding);
  }
}

/// A ray from there, seen on a notched face, goes through the corner of the notch but for 1e-24 m of
/// rounding.
TEST(MeshCollision, of_a_notched_cube_is_as_near_as_its_face_below_its_middle) {
  constexpr double kHalf = 0.02;
  const MeshCollider collider(notched_cube(kHalf));
  for (int i = 0; i < 1000; ++i) {
    const Vector3 off = 1e-23 * Vector3(std::sin(1.0 * i), std::sin(2.0 * i), 0.0);
    for (int axis = 0; axis < 3; ++axis) {
      Vector3 place = off;
      place[axis] = -0.0408949664;
      const auto found = collider.closest({place, place, 0.0}, 1.0);
      ASSERT_TRUE(found.has_value());
      EXPECT_NEAR(found->distance, -place[axis] - kHalf, 1e-12) << i;
    }
  }
}

TEST(MeshCollision, what_is_before_a_corner_that_points_inwards_leaves_by_it) {
  Random random(7);
  const MeshCollider collider(notched_cube(0.03));
  for (int i = 0; i < 2000 && !HasFailure(); ++i) {
    const Vector3 place = -Vector3::Constant(0.006) + random.in_box(Vector3::Constant(0.004));
    const Vector3 to_corner = -place;  // no nearer to the outer sides, which are 20 mm away
    const auto ball = collider.closest({place, place, 0.004}, kFar);
    SCOPED_TRACE(i);
    ASSERT_TRUE(ball);
    EXPECT_NEAR(ball->distance, -to_corner.norm() - 0.004, kRounding);
    EXPECT_LT((ball->normal - to_corner.normalized()).norm(), 1e-9);
    EXPECT_LT(ball->point.norm(), kRounding);
  }
}

TEST(MeshCollision, finger_in_an_arm_of_a_hollow_solid_leaves_across_the_arm) {
  const MeshCollider collider(angle_mesh());
  // Through the arm along x, nearer to its upper side than to its lower; the arm ends beyond the finger.
  const auto across = collider.closest({{0.015, -0.007, 0.001}, {0.035, -0.007, 0.001}, 0.006}, 0.001);
  ASSERT_TRUE(across);
  EXPECT_NEAR(across->distance, -0.007 - 0.006, kRounding);
  EXPECT_LT((across->normal - Vector3::UnitY()).norm(), kRounding);
  EXPECT_LT((across->point - Vector3(0.025, 0, 0.001)).norm(), kRounding);
  // A tip that came in from above by 3 mm.
  const auto tip = collider.closest({{-0.01, 0.02, 0.017}, {-0.008, 0.022, 0.045}, 0.006}, 0.001);
  ASSERT_TRUE(tip);
  EXPECT_NEAR(tip->distance, -0.003 - 0.006, kRounding);
  EXPECT_LT((tip->normal - Vector3::UnitZ()).norm(), kRounding);
}

TEST(MeshCollision, a_mesh_that_no_collider_has_read_is_touched_at_the_nearest_point_alone) {
  Mesh mesh;
  mesh.triangles = std::make_shared<TriangleMesh>(box_mesh({0.02, 0.02, 0.02}));
  ClosestFeatures features;
  features.axis_parameter = 0.3;
  const AxisSpan span = contact_span({{-0.01, 0, 0.03}, {0.01, 0, 0.03}, 0.008}, mesh, features);
  EXPECT_EQ(span.s0, 0.3);
  EXPECT_EQ(span.s1, 0.3);
}

TEST(MeshCollision, nothing_beyond_the_margin) {
  const MeshCollider collider(box_mesh({0.02, 0.02, 0.02}));
  const Capsule capsule{{0, 0, 0.031}, {0.01, 0, 0.031}, 0.008};
  EXPECT_FALSE(collider.closest(capsule, 0.0029));
  EXPECT_TRUE(collider.closest(capsule, 0.0031));
}

TEST(MeshCollision, open_surface_has_no_inside) {
  TriangleMesh sheet;
  sheet.vertices = {{-0.05, -0.05, 0}, {0.05, -0.05, 0}, {0, 0.05, 0}};
  sheet.triangles = {{{0, 1, 2}}};
  const auto below = MeshCollider(sheet).closest({{0, 0, -0.009}, {0, 0, -0.02}, 0.008}, 0.01);
  ASSERT_TRUE(below);
  EXPECT_NEAR(below->distance, 0.001, kRounding);
  EXPECT_LT((below->normal + Vector3::UnitZ()).norm(), kRounding);
}

TEST(MeshCollision, mesh_without_area_is_refused) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  mesh.triangles = {{{0, 1, 2}}};
  EXPECT_THROW(MeshCollider{mesh}, std::invalid_argument);
}

/// A ball with its top pushed in, a ring, an angle and a plain ball: hollow and not, fine and coarse.
std::vector<TriangleMesh> meshes() {
  TriangleMesh dented = testing::tessellated_ball(0.025, 40);
  for (Vector3& v : dented.vertices)
    if (v.z() > 0.01) v.z() = 0.02 - v.z();
  return {dented, testing::tessellated_ring(0.017, 0.008, 40), angle_mesh(),
          testing::tessellated_ball(0.025, 60)};
}

Capsule moved(const Capsule& capsule, double by, Random& random) {
  return {capsule.start + by * random.direction(), capsule.end + by * random.direction(), capsule.radius};
}

/// Asked for something else from many places in between.
class Forgetful {
 public:
  explicit Forgetful(const TriangleMesh& mesh) : collider_(mesh) {}
  std::optional<ClosestFeatures> closest(const Capsule& capsule, double margin) const {
    for (int i = 1; i <= 8; ++i) {  // twice as many as are remembered of one place
      const Vector3 aside = 1e-4 * i * Vector3(1, -1, 1);
      collider_.closest({capsule.start + aside, capsule.end - aside, capsule.radius}, margin);
    }
    return collider_.closest(capsule, margin);
  }

 private:
  MeshCollider collider_;
};

// A collider that has been asked before, again and again from almost the same place, says what a new one
// says.
TEST(MeshMemory, changes_no_bit_of_any_answer) {
  Random random(31);
  for (const TriangleMesh& mesh : meshes()) {
    const MeshCollider asked(mesh);
    const Forgetful forgetful(mesh);
    for (int place = 0; place < 30; ++place) {
      Capsule capsule = capsule_about(random.in_box(Vector3::Constant(0.035)),
                                      random.between(0.0, 0.025) * random.direction(), 0.008);
      for (const double by : {0.0, 1e-9, 1e-7, 1e-6, 1e-5, 5e-5, 2e-4}) {
        for (int i = 0; i < 4; ++i) {
          capsule = moved(capsule, by, random);
          expect_same(asked.closest(capsule, 0.005), forgetful.closest(capsule, 0.005));
        }
      }
    }
  }
}

/// A cone on its point with a pit of the same outline in it, of so many faces each.
TriangleMesh funnel(int faces) {
  TriangleMesh mesh;
  for (int i = 0; i < faces; ++i) {
    const double angle = 2.0 * M_PI * i / faces;
    mesh.vertices.push_back(0.03 * Vector3(std::cos(angle), std::sin(angle), 1.0));
  }
  mesh.vertices.push_back(Vector3::Zero());
  mesh.vertices.push_back(-0.02 * Vector3::UnitZ());
  for (int i = 0; i < faces; ++i) {
    const int next = (i + 1) % faces;
    mesh.triangles.push_back({{i, next, faces}});
    mesh.triangles.push_back({{next, i, faces + 1}});
  }
  return mesh;
}

// Before the pit's axis all of its faces are as near.
TEST(MeshMemory, changes_no_bit_where_more_faces_are_near_than_are_remembered) {
  Random random(33);
  const TriangleMesh mesh = funnel(60);
  const MeshCollider asked(mesh);
  const Forgetful forgetful(mesh);
  for (int i = 0; i < 200 && !HasFailure(); ++i) {
    const Vector3 place(0.0, 0.0, 0.015);
    const Capsule capsule = moved({place, place, 0.004}, 2e-5, random);
    expect_same(asked.closest(capsule, 0.05), forgetful.closest(capsule, 0.05));
  }
}

// Two simulations with the same mesh share its collider and know nothing of it (shared_collider): a program
// that runs each in a thread of its own must not need a lock.
TEST(MeshMemory, may_be_shared_between_threads) {
  const TriangleMesh mesh = meshes().front();
  const MeshCollider shared(mesh), alone(mesh);
  std::vector<Capsule> capsules;
  Random random(32);
  for (int i = 0; i < 40; ++i) {
    const Capsule first =
        capsule_about(random.in_box(Vector3::Constant(0.03)), 0.01 * random.direction(), 0.008);
    for (int k = 0; k < 50; ++k) capsules.push_back(moved(first, 1e-6, random));
  }
  std::vector<std::optional<ClosestFeatures>> expected;
  for (const Capsule& capsule : capsules) expected.push_back(alone.closest(capsule, 0.005));
  std::array<std::vector<std::optional<ClosestFeatures>>, 2> answers;
  std::vector<std::thread> threads;
  for (auto& of_thread : answers)
    threads.emplace_back([&] {
      for (const Capsule& capsule : capsules) of_thread.push_back(shared.closest(capsule, 0.005));
    });
  for (std::thread& thread : threads) thread.join();
  for (const auto& of_thread : answers)
    for (std::size_t i = 0; i < expected.size(); ++i) expect_same(of_thread[i], expected[i]);
}

}  // namespace
}  // namespace mrhi
