#include <gtest/gtest.h>

#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/scene/shape.h"
#include "mr_hand_interaction/synthetic/random.h"
#include "scene/solid_mesh.h"
#include "support/tessellated.h"

/// What every shape answers, against what its definition says of a great many places.
namespace mrhi {
namespace {

Vector3 direction(Random& random) {
  return random.gaussian_vector(1.0).normalized();
}
Quaternion any_turn(Random& random) {
  return Quaternion(random.gaussian(), random.gaussian(), random.gaussian(), random.gaussian()).normalized();
}

/// A shape, and whether a place is in it.
struct Known {
  const char* name;
  Shape shape;
  bool (*holds)(const Vector3& place);
};

Shape mesh_of(TriangleMesh mesh) {
  return Mesh{std::make_shared<const TriangleMesh>(std::move(mesh)), "", Vector3::Ones()};
}

const Known kKnown[] = {
    {"ball", Sphere{0.03}, [](const Vector3& p) { return p.norm() <= 0.03; }},
    {"box", Box{{0.03, 0.02, 0.01}},
     [](const Vector3& p) {
       return std::abs(p.x()) <= 0.03 && std::abs(p.y()) <= 0.02 && std::abs(p.z()) <= 0.01;
     }},
    {"can", Cylinder{0.02, 0.03},
     [](const Vector3& p) { return p.head<2>().norm() <= 0.02 && std::abs(p.z()) <= 0.03; }},
    {"capsule", Pill{0.015, 0.02},
     [](const Vector3& p) {
       return (p - Vector3(0, 0, std::max(-0.02, std::min(p.z(), 0.02)))).norm() <= 0.015;
     }},
    {"mesh", mesh_of(testing::tessellated_box({0.03, 0.02, 0.01}, 3)), [](const Vector3& p) {
       return std::abs(p.x()) <= 0.03 && std::abs(p.y()) <= 0.02 && std::abs(p.z()) <= 0.01;
     }}};

class KnownShape : public ::testing::TestWithParam<Known> {
 protected:
  template <typename Ask>
  auto ask(const Ask& question) const {
    return std::visit(question, GetParam().shape);
  }
  bool holds(const Vector3& place) const { return GetParam().holds(place); }
};

TEST_P(KnownShape, has_the_moments_of_a_solid) {
  constexpr int kCells = 120;
  constexpr double kHalf = 0.04, kCell = 2.0 * kHalf / kCells;
  SolidMoments sum;
  for (int i = 0; i < kCells; ++i) {
    for (int j = 0; j < kCells; ++j) {
      for (int k = 0; k < kCells; ++k) {
        const Vector3 place = kCell * Vector3(i + 0.5, j + 0.5, k + 0.5) - Vector3::Constant(kHalf);
        if (!holds(place)) continue;
        sum.volume += 1.0, sum.first += place, sum.second += place * place.transpose();
      }
    }
  }
  const double cell = kCell * kCell * kCell;
  const SolidMoments moments = ask([](const auto& shape) { return shape.moments(); });
  // A cell on the surface counts whole or not at all; 0.7 mm cells of both kinds nearly even out.
  EXPECT_NEAR(moments.volume, cell * sum.volume, 0.01 * moments.volume);
  EXPECT_LT((moments.first - cell * sum.first).norm(), 1e-4 * moments.volume * 0.03);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j)
      EXPECT_NEAR(moments.second(i, j), cell * sum.second(i, j), 0.01 * moments.second.trace()) << i << j;
  }
}

TEST_P(KnownShape, nothing_of_it_is_farther_than_its_farthest_point) {
  Random random(1);
  std::vector<Vector3> inside;
  while (inside.size() < 1000) {
    const Vector3 place = random.gaussian_vector(0.015);
    if (holds(place)) inside.push_back(place);
  }
  for (int i = 0; i < 100; ++i) {
    const Vector3 n = direction(random);
    const Vector3 farthest = ask([&](const auto& shape) { return shape.farthest(n); });
    EXPECT_TRUE(holds((1.0 - 1e-9) * farthest));
    for (const Vector3& place : inside) EXPECT_LE(n.dot(place), n.dot(farthest) + 1e-12);
  }
}

TEST_P(KnownShape, its_radius_is_that_of_its_farthest_point_of_all) {
  Random random(2);
  double farthest = 0.0;
  for (int i = 0; i < 3000; ++i)
    farthest = std::max(farthest,
                        ask([n = direction(random)](const auto& shape) { return shape.farthest(n); }).norm());
  const double radius = bounding_radius(GetParam().shape);
  EXPECT_LE(farthest, radius + 1e-12);
  EXPECT_GT(farthest, 0.999 * radius);
}

TEST_P(KnownShape, the_way_out_ends_on_the_surface) {
  if (std::holds_alternative<Mesh>(GetParam().shape)) return;  // its MeshCollider's to tell
  Random random(3);
  int met = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vector3 from = random.gaussian_vector(0.02), along = direction(random);
    const auto way = ask([&](const auto& shape) { return shape.exit_distance(from, along); });
    EXPECT_TRUE(way || !holds(from));
    if (!way) continue;
    ++met;
    EXPECT_TRUE(holds(from + (*way - 1e-7) * along) || !holds(from));  // a line may touch a corner alone
    for (const double beyond : {1e-9, 0.001, 0.01, 0.1}) EXPECT_FALSE(holds(from + (*way + beyond) * along));
  }
  EXPECT_GT(met, 300);
}

TEST_P(KnownShape, inertia_is_that_of_its_parts_wherever_they_are_placed) {
  Random random(4);
  const Matrix3 own = inertia_of({{GetParam().shape, {}}}, 0.2);
  EXPECT_EQ(own, own.transpose());
  for (int i = 0; i < 20; ++i) {
    const Pose pose{0.1 * random.gaussian_vector(1.0).normalized(), any_turn(random)};
    const Matrix3 turn = pose.orientation.toRotationMatrix();
    const Vector3& p = pose.position;
    // Steiner: the shapes here have their centres of mass at their origins.
    const Matrix3 expected =
        turn * own * turn.transpose() + 0.2 * (p.squaredNorm() * Matrix3::Identity() - p * p.transpose());
    EXPECT_LT((inertia_of({{GetParam().shape, pose}}, 0.2) - expected).norm(), 1e-12);
    // Two of them, back to back: the mass is shared by volume.
    const Pose behind{-p, pose.orientation};
    EXPECT_LT((inertia_of({{GetParam().shape, pose}, {GetParam().shape, behind}}, 0.2) - expected).norm(),
              1e-12);
  }
  EXPECT_LT((inertia_of({{GetParam().shape, {}}}, 0.4) - 2.0 * own).norm(), 1e-15);
}

TEST_P(KnownShape, is_a_capsule_within_if_that_is_what_it_is) {
  const std::optional<Capsule> core = ask([](const auto& shape) { return shape.core(); });
  const std::string name = GetParam().name;
  ASSERT_EQ(core.has_value(), name == "ball" || name == "capsule");
  if (!core) return;
  Random random(5);
  for (int i = 0; i < 100; ++i) {
    const Vector3 n = direction(random);
    const Vector3 end = n.dot(core->end) > n.dot(core->start) ? core->end : core->start;
    const Vector3 farthest = ask([&](const auto& shape) { return shape.farthest(n); });
    EXPECT_NEAR(n.dot(farthest), n.dot(end) + core->radius, 1e-15);
  }
}

INSTANTIATE_TEST_SUITE_P(, KnownShape, ::testing::ValuesIn(kKnown),
                         [](const auto& known) { return std::string(known.param.name); });

TEST(ConvexHull, holds_every_vertex_is_convex_and_closed) {
  Random random(6);
  for (int i = 0; i < 20; ++i) {
    TriangleMesh cloud;
    for (int p = 0; p < 4 + 5 * i; ++p) cloud.vertices.push_back(random.gaussian_vector(0.03));
    TriangleMesh hull = convex_hull(cloud);
    make_solid(hull);
    EXPECT_GT(signed_volume(hull), 0.0);
    for (const auto& t : hull.triangles) {
      const Vector3& a = hull.vertices[std::size_t(t[0])];
      const Vector3 n = (hull.vertices[std::size_t(t[1])] - a).cross(hull.vertices[std::size_t(t[2])] - a);
      for (const Vector3& vertex : cloud.vertices) EXPECT_LE(n.normalized().dot(vertex - a), 1e-12);
    }
    // Euler's formula of a closed surface: V - E + F = 2 with E = 3 F / 2.
    EXPECT_EQ(hull.vertices.size(), 2 + hull.triangles.size() / 2);
  }
}

TEST(ConvexHull, of_a_hull_is_the_hull) {
  const TriangleMesh box = testing::tessellated_box({0.03, 0.02, 0.01}, 4);
  TriangleMesh once = convex_hull(box), twice = convex_hull(once);
  make_solid(once), make_solid(twice);
  EXPECT_EQ(once.vertices.size(), 8u);
  EXPECT_EQ(twice.vertices.size(), 8u);
  EXPECT_NEAR(signed_volume(once), 8 * 0.03 * 0.02 * 0.01, 1e-15);
  EXPECT_NEAR(signed_volume(twice), signed_volume(once), 1e-18);
}

TEST(ConvexHull, needs_corners_that_are_not_in_one_plane) {
  TriangleMesh flat;
  flat.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0.3, 0.4, 0}};
  EXPECT_THROW(convex_hull(flat), std::runtime_error);
  flat.vertices.resize(3);
  EXPECT_THROW(convex_hull(flat), std::runtime_error);
  EXPECT_THROW(convex_hull({}), std::runtime_error);
}

TEST(MakeSolid, turns_outward_what_is_turned_inward_and_changes_nothing_twice) {
  const TriangleMesh good = testing::tessellated_box({0.03, 0.02, 0.01}, 2);
  TriangleMesh turned = good;
  for (auto& triangle : turned.triangles) std::swap(triangle[1], triangle[2]);
  EXPECT_NEAR(signed_volume(turned), -8 * 0.03 * 0.02 * 0.01, 1e-15);
  make_solid(turned);
  EXPECT_EQ(turned.triangles, good.triangles);
  make_solid(turned);
  EXPECT_EQ(turned.triangles, good.triangles);
}

// What one exporter or another writes: each face both ways, one twice, one turned, one missing of many.
TEST(MakeSolid, repairs_the_faults_of_exporters_and_assumes_nothing) {
  const TriangleMesh good = testing::tessellated_box({0.03, 0.02, 0.01}, 30);
  const double volume = signed_volume(good);
  TriangleMesh both_ways = good, doubled = good, turned = good, holed = good;
  for (std::array<int, 3> t : good.triangles) both_ways.triangles.push_back({{t[0], t[2], t[1]}});
  doubled.triangles.push_back(doubled.triangles.front());
  std::swap(turned.triangles[7][0], turned.triangles[7][1]);
  holed.triangles.erase(holed.triangles.begin() + 40);
  for (TriangleMesh* mesh : {&both_ways, &doubled, &turned, &holed}) {
    EXPECT_EQ(make_solid(*mesh), std::vector<std::string>{});
    EXPECT_NEAR(signed_volume(*mesh), volume, 1e-12);
    EXPECT_EQ(mesh->triangles.size(), good.triangles.size());
  }
}

TriangleMesh boxes(const std::vector<std::pair<Vector3, Vector3>>& sizes_and_places) {
  TriangleMesh all;
  for (const auto& [half, place] : sizes_and_places) {
    const TriangleMesh box = testing::tessellated_box(half, 1);
    const int first = static_cast<int>(all.vertices.size());
    for (const Vector3& vertex : box.vertices) all.vertices.push_back(vertex + place);
    for (const auto& t : box.triangles) all.triangles.push_back({{t[0] + first, t[1] + first, t[2] + first}});
  }
  return all;
}

double solid_volume(TriangleMesh mesh, std::size_t turned_from = 1000) {
  for (std::size_t t = turned_from; t < mesh.triangles.size(); ++t)
    std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
  EXPECT_EQ(make_solid(mesh), std::vector<std::string>{});
  return Mesh{std::make_shared<const TriangleMesh>(mesh), "", Vector3::Ones()}.moments().volume;
}

// 1e-3: what parts share is measured along lines.
TEST(MakeSolid, counts_parts_that_are_apart_overlap_or_hold_each_other_once) {
  const Vector3 half = Vector3::Constant(0.02), far(0.1, 0, 0), near(0.03, 0.001, 0.002);
  const double one = 6.4e-5;
  EXPECT_NEAR(solid_volume(boxes({{half, Vector3::Zero()}, {half, far}}), 12), 2 * one, 1e-15);
  EXPECT_NEAR(solid_volume(boxes({{half, Vector3::Zero()}, {half, near}})), 2 * one - 0.01 * 0.039 * 0.038,
              1e-3 * one);
  EXPECT_NEAR(solid_volume(boxes({{half, Vector3::Zero()}, {0.5 * half, Vector3::Zero()}})), one, 1e-15);
  // Turned against the one around it, it is a cavity.
  EXPECT_NEAR(solid_volume(boxes({{half, Vector3::Zero()}, {0.5 * half, Vector3::Zero()}}), 12), 0.875 * one,
              1e-15);
}

TEST(MakeSolid, takes_the_hull_of_what_is_open_says_so_and_leaves_sheets_out) {
  TriangleMesh open = testing::tessellated_box({0.03, 0.02, 0.01}, 1);
  open.triangles.resize(open.triangles.size() - 2);
  const std::vector<std::string> assumed = make_solid(open);
  ASSERT_EQ(assumed.size(), 1u);
  EXPECT_NE(assumed[0].find("convex hull"), std::string::npos);
  EXPECT_NEAR(signed_volume(open), 8 * 0.03 * 0.02 * 0.01, 1e-15);
  TriangleMesh sheet = boxes({{Vector3::Constant(0.02), Vector3::Zero()}});
  const int first = static_cast<int>(sheet.vertices.size());
  for (const Vector3& v : {Vector3(0, 0, 0.1), Vector3(0.1, 0, 0.1), Vector3(0, 0.1, 0.1)})
    sheet.vertices.push_back(v);
  sheet.triangles.push_back({{first, first + 1, first + 2}});
  TriangleMesh only_sheet{sheet.vertices, {sheet.triangles.back()}};
  EXPECT_EQ(make_solid(sheet), std::vector<std::string>{"has flat sheets, which are left out"});
  EXPECT_NEAR(signed_volume(sheet), 6.4e-5, 1e-15);
  EXPECT_THROW(make_solid(only_sheet), NoVolume);
}

}  // namespace
}  // namespace mrhi
