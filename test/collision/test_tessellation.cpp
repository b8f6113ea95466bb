#include <gtest/gtest.h>

#include "collision/body_manifold.h"
#include "collision/mesh_collision.h"
#include "collision/mesh_surface.h"
#include "collision/mesh_tree.h"
#include "collision/scene_geometry.h"
#include "mesh_shapes.h"
#include "random_capsules.h"
#include "same_features.h"
#include "support/tessellated.h"

namespace mrhi {
namespace {

using testing::in_floats;
using testing::shuffled;
using testing::tessellated_ball;
using testing::tessellated_box;
using testing::tessellated_can;
using testing::tessellated_ring;

const Vector3 kHalf(0.05, 0.04, 0.01);
const Quaternion kTurn(Eigen::AngleAxisd(0.7, Vector3(1, 2, 3).normalized()));

TEST(FlatFaces, a_box_has_six_however_it_is_cut) {
  for (const int n : {1, 2, 7, 32, 90}) {
    for (const bool as_in_a_file : {false, true}) {
      SCOPED_TRACE(n);
      TriangleMesh mesh = tessellated_box(kHalf, n);
      if (as_in_a_file) mesh = in_floats(testing::turned(mesh, kTurn));
      const FlatFaces flat = merge_coplanar_triangles(mesh);
      EXPECT_EQ(flat.faces.size(), 6u);
      EXPECT_EQ(flat.edges.size(), 12u);
      EXPECT_EQ(flat.corners.size(), 8u);
      EXPECT_TRUE(flat.closed && flat.one_piece);
      EXPECT_TRUE(MeshSurface(mesh).convex());
    }
  }
}

TEST(FlatFaces, a_can_has_two_caps_and_its_sides) {
  const FlatFaces flat = merge_coplanar_triangles(in_floats(tessellated_can(0.033, 0.06, 71, 40, 20)));
  EXPECT_EQ(flat.faces.size(), 73u);
  EXPECT_EQ(flat.edges.size(), 3u * 71u);
  EXPECT_EQ(flat.corners.size(), 2u * 71u);
}

TEST(FlatFaces, what_bends_everywhere_keeps_its_patches) {
  const TriangleMesh ring = in_floats(tessellated_ring(0.04, 0.015, 40));
  const FlatFaces flat = merge_coplanar_triangles(ring);
  EXPECT_EQ(flat.faces.size(), 3200u);  // four-cornered: each is flat
  EXPECT_FALSE(MeshSurface(ring).convex());
}

TEST(FlatFaces, triangles_of_no_area_belong_to_those_beside_them) {
  // A box one of whose edges is split by a vertex that only one of its faces has: closed by a needle.
  TriangleMesh mesh = tessellated_box(kHalf, 1);
  const std::array<int, 3> cut = mesh.triangles[0];
  const int middle = int(mesh.vertices.size());
  mesh.vertices.push_back(0.5 * (mesh.vertices[std::size_t(cut[0])] + mesh.vertices[std::size_t(cut[1])]));
  mesh.triangles[0] = {{cut[0], middle, cut[2]}};
  mesh.triangles.push_back({{middle, cut[1], cut[2]}});
  mesh.triangles.push_back({{cut[0], cut[1], middle}});
  const FlatFaces flat = merge_coplanar_triangles(mesh);
  EXPECT_EQ(flat.faces.size(), 6u);
  EXPECT_TRUE(flat.closed);
}

TEST(Tessellation, order_of_triangles_and_vertices_changes_no_bit) {
  for (const TriangleMesh& mesh : {tessellated_box(kHalf, 9), tessellated_can(0.033, 0.06, 40, 10, 5),
                                   tessellated_ball(0.03, 20), tessellated_ring(0.04, 0.015, 20)}) {
    Random random(21);
    const MeshCollider one(mesh), other(shuffled(mesh, 1));
    for (int i = 0; i < 3000 && !HasFailure(); ++i) {
      const Capsule capsule = capsule_about(random.in_box({0.06, 0.06, 0.06}),
                                            random.between(0.0, 0.04) * random.direction(), 0.008);
      expect_same(one.closest(capsule, 0.02), other.closest(capsule, 0.02));
    }
  }
}

TEST(Tessellation, what_was_asked_before_changes_no_bit) {
  for (const TriangleMesh& mesh :
       {tessellated_box(kHalf, 9), tessellated_ball(0.03, 20), tessellated_ring(0.04, 0.015, 20)}) {
    Random random(22);
    const MeshCollider used(mesh);
    for (int i = 0; i < 20 && !HasFailure(); ++i) {
      const MeshCollider fresh(mesh);
      Capsule capsule = capsule_about(random.in_box({0.06, 0.06, 0.06}),
                                      random.between(0.0, 0.04) * random.direction(), 0.008);
      expect_same(used.closest(capsule, 0.02), fresh.closest(capsule, 0.02));
      for (int k = 0; k < 30; ++k) {  // creeps along, with what it was near to in mind
        const Vector3 creep = 1e-5 * random.direction();
        capsule.start += creep, capsule.end += 1.1 * creep;
        used.closest(capsule, 0.02);
      }
      const MeshCollider fresh_there(mesh);
      expect_same(used.closest(capsule, 0.02), fresh_there.closest(capsule, 0.02));
    }
  }
}

/// The least distance of an axis from a surface, over all its parts.
double brute_distance(const MeshSurface& surface, const Segment& segment) {
  double least = 1e300;
  for (int f = 0; f < int(surface.faces().size()); ++f)
    least = std::min(least, surface.nearest_on_face(f, segment).distance);
  for (int e = 0; e < int(surface.edges().size()); ++e)
    least = std::min(least, surface.nearest_on_edge(e, segment).distance);
  return least;
}

TEST(Tessellation, nothing_is_nearer_than_what_the_tree_finds) {
  for (const TriangleMesh& mesh : {tessellated_can(0.033, 0.06, 40, 10, 5), tessellated_ball(0.03, 30),
                                   tessellated_ring(0.04, 0.015, 20)}) {
    Random random(23);
    const MeshCollider collider(mesh);
    const MeshSurface surface(mesh);
    int outside = 0;
    for (int i = 0; i < 1500 && !HasFailure(); ++i) {
      const Capsule capsule = capsule_about(random.in_box({0.07, 0.07, 0.07}),
                                            random.between(0.0, 0.04) * random.direction(), 0.008);
      const auto found = collider.closest(capsule, 1.0);
      ASSERT_TRUE(found);
      if (found->distance + capsule.radius < 1e-9) continue;
      ++outside;
      EXPECT_EQ(found->distance + capsule.radius, brute_distance(surface, Segment(capsule)) - 0.008 + 0.008);
    }
    EXPECT_GT(outside, 500);
  }
}

TEST(Tessellation, the_way_out_of_a_ball_is_along_its_radius) {
  const double radius = 0.03;
  const int k = 100;
  const MeshCollider collider(tessellated_ball(radius, k));
  Random random(24);
  for (int i = 0; i < 2000 && !HasFailure(); ++i) {
    const Vector3 outward = random.direction();
    const Vector3 middle = random.between(0.5, 0.9) * radius * outward;
    const Vector3 half = random.between(0.0, 0.01) * any_normal(outward);
    const Capsule capsule{middle - half, middle + half, 0.008};
    const auto found = collider.closest(capsule, 0.001);
    ASSERT_TRUE(found);
    // Of chords across the radius the middle is deepest; facets are inside by up to r (pi / 2k)^2 / 2 * 2.
    EXPECT_NEAR(found->distance, middle.norm() - radius - 0.008, radius * std::pow(M_PI / k, 2));
    EXPECT_GT(found->normal.dot(outward), 0.99);
  }
}

TEST(Tessellation, a_finger_lies_along_a_face_as_along_a_boxs) {
  const Box box{kHalf};
  Random random(25);
  for (const int n : {1, 10, 60}) {
    const MeshCollider collider(tessellated_box(kHalf, n));
    for (int i = 0; i < 300 && !HasFailure(); ++i) {
      const Vector3 start(random.between(-0.07, 0.04), random.between(-0.03, 0.03), 0.017);
      const Capsule capsule{start, start + Vector3(0.025, 0.002, random.between(-1e-3, 1e-3)), 0.008};
      const auto mesh = collider.closest(capsule, 0.001);
      const ClosestFeatures features = capsule_box(capsule, box);
      ASSERT_EQ(bool(mesh), features.distance <= 0.001);
      if (!mesh || features.normal.z() < 1.0 - 1e-9) continue;
      EXPECT_NEAR(mesh->distance, features.distance, 1e-12);
      const AxisSpan of_box = contact_span(capsule, box, features), of_mesh = collider.span(capsule, *mesh);
      if ((of_box.s1 - of_box.s0) * 0.025 < 0.0021) continue;
      EXPECT_NEAR(of_mesh.s0, of_box.s0, 1e-9);
      EXPECT_NEAR(of_mesh.s1, of_box.s1, 1e-9);
    }
  }
}

/// Part of the capsule's axis on which its pad lies.
AxisSpan pad(const PlacedCollider& collider, const Capsule& capsule) {
  return collider.pad(capsule, *collider.closest(capsule, 1.0));
}
struct PlacedMesh {
  explicit PlacedMesh(const TriangleMesh& mesh) : collider(mesh) {}
  MeshCollider collider;
  PlacedShape shape{Mesh{std::make_shared<const TriangleMesh>(), "", Vector3::Ones()}, Pose()};
  PlacedCollider placed{shape, &collider};
};

TEST(Tessellation, a_finger_beside_an_edge_lies_on_the_faces_of_a_box) {
  constexpr double kLength = 0.025;   // [m]
  constexpr double kShort = 0.00201;  // [m]: shorter pads of a mesh are points
  const PlacedShape box{Box{kHalf}, Pose()};
  const PlacedCollider of_box(box, nullptr);
  Random random(26);
  for (const int n : {1, 10}) {
    const PlacedMesh mesh(tessellated_box(kHalf, n));
    int at_edges = 0;
    for (int i = 0; i < 3000 && !HasFailure(); ++i) {
      const Vector3 along =
          kLength * Vector3(1.0, random.between(-0.5, 0.5), random.between(-0.1, 0.1)).normalized();
      const Vector3 middle(random.between(-0.06, 0.06), random.between(-0.03, 0.03), 0.016);
      const Capsule capsule{middle - 0.5 * along, middle + 0.5 * along, 0.008};
      const ClosestFeatures features = *of_box.closest(capsule, 1.0);
      const AxisSpan a = of_box.pad(capsule, features), b = pad(mesh.placed, capsule);
      if ((a.s1 - a.s0) * kLength < kShort) continue;
      EXPECT_NEAR(b.s0, a.s0, 1e-4) << i;  // 2.5 um: the mesh's pad is that of a line 0.1 um beside the axis
      EXPECT_NEAR(b.s1, a.s1, 1e-4) << i;
      if (of_box.span(capsule, features).at_edge) ++at_edges;
    }
    EXPECT_GT(at_edges, 100);
  }
}

TEST(Tessellation, a_finger_beside_an_edge_lies_on_a_face_that_is_not_convex) {
  const PlacedMesh angle(angle_mesh());
  for (const double rise : {-0.001, 0.001}) {  // over either edge of an arm of 20 mm
    const Vector3 start(0.02, -0.03, 0.026), along(0.0, 0.04, rise);
    const Capsule capsule{start, start + along, 0.008};
    const double depth = -angle.placed.closest(capsule, 1.0)->distance;
    const double length = 0.5 * (1.0 - 0.5 * std::abs(rise) / depth);
    const AxisSpan span = pad(angle.placed, capsule);
    EXPECT_NEAR(span.s1 - span.s0, length, 1e-3);
    EXPECT_NEAR(rise > 0.0 ? span.s0 : span.s1, rise > 0.0 ? 0.25 : 0.75, 0.01);
  }
}

// With D the depth, a ball of radius R falls away from the pad by x^2 / 2 R, so that it lies on the integral
// of max(0, 1 - x^2 / R D) to either side, but for its tilt x / R.
TEST(Tessellation, a_finger_lies_on_the_facets_of_a_ball_as_on_the_ball) {
  const double radius = 0.02, depth = 0.002, half_length = 0.012;
  double side = 0.0;
  for (double x = 0.5e-6; x < half_length; x += 1e-6)
    side += 1e-6 * std::max(0.0, 1.0 - std::max(x * x / (radius * depth), x / (kMaxTilt * radius)));
  Random random(27);
  const TriangleMesh mesh = tessellated_ball(radius, 80);
  const MeshCollider collider(mesh);
  const MeshSurface surface(mesh);
  for (int i = 0; i < 200 && !HasFailure(); ++i) {
    const Vector3 out = random.direction();
    const Vector3 half =
        half_length * Eigen::AngleAxisd(random.between(0.0, 6.0), out).toRotationMatrix() * any_normal(out);
    const Vector3 middle = (radius + 0.008 - depth) * out;
    const Capsule capsule{middle - half, middle + half, 0.008};
    const Pad span = surface.pad(Segment(capsule), *collider.closest(capsule, 0.001));
    EXPECT_NEAR((span.s1 - span.s0) * half_length, side, 0.1 * side) << i;  // facets of 0.8 mm
    EXPECT_NEAR(0.5 * (span.s0 + span.s1), 0.5, 0.2e-3 / half_length) << i;
  }
}

TEST(Tessellation, touches_are_those_of_the_shape_in_any_cut_and_order) {
  const Shape plate = Box{{0.5, 0.5, 0.05}};
  Random random(26);
  const auto touches = [&](const TriangleMesh& triangles, const Pose& pose) {
    const MeshCollider collider(triangles);
    const Shape shape = Mesh{std::make_shared<const TriangleMesh>(triangles), "", Vector3::Ones()};
    return body_manifold({shape, &collider}, pose, plate, {{0, 0, -0.05}, Quaternion::Identity()}, 0.001);
  };
  for (int i = 0; i < 20; ++i) {
    const Quaternion turn(Eigen::AngleAxisd(random.between(-3.0, 3.0), Vector3::UnitZ()));
    const Quaternion tilt(Eigen::AngleAxisd(random.between(0.0, 1e-3), random.direction()));
    const Pose pose{{random.between(-0.1, 0.1), 0.02, kHalf.z() - 1e-4}, tilt * turn};
    const Manifold coarse = touches(tessellated_box(kHalf, 1), pose);
    EXPECT_GE(coarse.count, 3);
    for (const int n : {2, 14, 33}) {
      const Manifold fine = touches(shuffled(tessellated_box(kHalf, n), unsigned(n)), pose);
      ASSERT_EQ(fine.count, coarse.count);
      EXPECT_LT((fine.normal - coarse.normal).norm(), 1e-12);
      for (int k = 0; k < fine.count; ++k) {
        const ManifoldPoint &a = fine.points[std::size_t(k)], &b = coarse.points[std::size_t(k)];
        EXPECT_NEAR(a.depth, b.depth, 1e-12);
        EXPECT_LT((a.point - b.point).norm(), 1e-12);
        EXPECT_EQ(a.feature, b.feature);
      }
    }
  }
}

}  // namespace
}  // namespace mrhi
