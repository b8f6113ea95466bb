#include <gtest/gtest.h>

#include <cmath>

#include "collision/body_contact_finder.h"
#include "collision/overlap.h"
#include "mr_hand_interaction/scene/scene.h"
#include "placed_shapes.h"

namespace mrhi {
namespace {

/// A conical cup with its floor at 0, of `sides` long thin faces round: radii of the base and of the rim, and
/// thickness of its wall [m].
TriangleMesh conical_cup(double base, double rim, double wall, double height, int sides) {
  const std::array<std::pair<double, double>, 4> profile{
      {{base, 0.0}, {rim, height}, {rim - wall, height}, {base - wall, wall}}};
  TriangleMesh mesh;
  const auto ring = [&](int k, int i) { return k * sides + i % sides; };
  for (const auto& [radius, z] : profile)
    for (int i = 0; i < sides; ++i) {
      const double angle = 2.0 * M_PI * i / sides;
      mesh.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    }
  const int bottom = 4 * sides, floor = bottom + 1;
  mesh.vertices.emplace_back(0, 0, 0);
  mesh.vertices.emplace_back(0, 0, wall);
  for (int i = 0; i < sides; ++i) {
    mesh.triangles.push_back({bottom, ring(0, i + 1), ring(0, i)});
    for (int k = 0; k < 3; ++k) {
      mesh.triangles.push_back({ring(k, i), ring(k, i + 1), ring(k + 1, i + 1)});
      mesh.triangles.push_back({ring(k, i), ring(k + 1, i + 1), ring(k + 1, i)});
    }
    mesh.triangles.push_back({ring(3, i), ring(3, i + 1), floor});
  }
  return mesh;
}

struct Cups {
  explicit Cups(double wall, int sides)
      : mesh(std::make_shared<const TriangleMesh>(conical_cup(0.03, 0.04, wall, 0.08, sides))),
        shape(Mesh{mesh, "", Vector3::Ones()}),
        collider(shared_collider(mesh)) {}

  Manifold manifold(const Pose& upper, SearchBudget& budget) const {
    const ManifoldShape cup{shape, collider.get()};
    return body_manifold(cup, upper, cup, Pose(), 0.001, kAnyBreadth, &budget);
  }

  /// With the other cup as the second body.
  Scene two(const Pose& upper) const {
    Scene scene;
    for (const char* name : {"lower", "upper"}) {
      Body body;
      body.name = name;
      body.mass = 0.1;
      body.shapes = {{shape, {}}};
      complete(body);
      scene.bodies.push_back(body);
    }
    scene.bodies[1].start = upper;
    return scene;
  }

  std::shared_ptr<const TriangleMesh> mesh;
  Shape shape;
  std::shared_ptr<const MeshCollider> collider;
};

/// What a pair may take: the last search of each of `stages` and samples may be a deep one that exceeds its
/// part.
double max_spent(const Cups& cups, double left, double sample, int stages = 1) {
  return left + 2.0 * sample + (2.0 + 2.0 * stages) * cups.collider->deep_search_cost(1.0);
}

TEST(MeshBudget, bounds_the_searches_of_cups_in_each_other_however_fine_and_near) {
  for (const int sides : {500, 3000}) {
    for (const double wall : {0.0009, 0.002}) {
      const Cups cups(wall, sides);
      for (const double raised : {0.0, 1e-4, 0.0163, 0.0166, 0.019}) {
        SearchBudget budget;
        const Manifold manifold = cups.manifold(at(0, 0, raised), budget);
        EXPECT_LE(budget.spent, max_spent(cups, SearchBudget::kPair, SearchBudget::kSample))
            << sides << " " << wall << " " << raised;
        if (raised == 0.0) {
          EXPECT_GE(manifold.count, 2) << sides << " " << wall;
        }
      }
    }
  }
}

TEST(MeshBudget, of_a_step_is_shared_by_its_pairs) {
  const SearchBudget first = SearchBudget::after(0.0), last = SearchBudget::after(SearchBudget::kStep + 1.0);
  EXPECT_EQ(first.left, SearchBudget::kPair);
  EXPECT_LE(last.left, 0.0);
  const Cups cups(0.002, 500);
  SearchBudget budget = last;
  cups.manifold(at(0, 0, 1e-4), budget);
  EXPECT_LE(budget.spent, max_spent(cups, 0.0, SearchBudget::kMinSample));
}

TEST(MeshBudget, that_is_exhausted_gives_the_same_bits_again) {
  const Cups cups(0.002, 500);
  SearchBudget one, other;
  const Manifold first = cups.manifold(at(1e-4, 0, 0.016), one),
                 second = cups.manifold(at(1e-4, 0, 0.016), other);
  ASSERT_LT(one.left, 0.0);
  EXPECT_EQ(one.spent, other.spent);
  ASSERT_EQ(first.count, second.count);
  for (int i = 0; i < first.count; ++i) {
    EXPECT_EQ(first.points[std::size_t(i)].depth, second.points[std::size_t(i)].depth);
    EXPECT_EQ(first.points[std::size_t(i)].point, second.points[std::size_t(i)].point);
  }
}

// Frames wait while a spawn looks for a free place.
TEST(Overlap, takes_no_more_searches_than_its_budget) {
  constexpr double kLimit = 1000.0;
  const Cups cups(0.002, 3000);
  for (const double raised : {0.0, 0.019, 0.03, 0.07, 0.2}) {
    const Scene scene = cups.two(at(0, 0, raised));
    const SceneGeometry geometry(scene);
    const std::vector<BodyState> states{start_state(scene.bodies[0]), start_state(scene.bodies[1])};
    SearchBudget budget;
    budget.left = kLimit;
    const Overlap found = overlap(scene, geometry, states, 1, 0, budget);
    EXPECT_LE(budget.spent, max_spent(cups, kLimit, SearchBudget::kSample, 4)) << raised;
    if (raised == 0.0) {
      EXPECT_FALSE(found.is_allowed());
    }
    if (raised == 0.2) {
      EXPECT_EQ(budget.spent, 0.0) << "boxes apart need no search";
    }
  }
}

TEST(Overlap, of_bodies_of_many_shapes_has_a_budget_too) {
  constexpr double kLimit = 100.0;
  Scene scene;
  for (const char* name : {"one", "other"}) {
    Body body;
    body.name = name;
    body.mass = 0.1;
    for (int i = 0; i < 200; ++i) body.shapes.push_back({Sphere{0.0005}, at(1e-6 * i, 1e-6 * i, 0.0)});
    body.start = at(0, 0, scene.bodies.empty() ? 0.0 : 0.0008);
    complete(body);
    scene.bodies.push_back(body);
  }
  const SceneGeometry geometry(scene);
  const std::vector<BodyState> states{start_state(scene.bodies[0]), start_state(scene.bodies[1])};
  SearchBudget budget;
  budget.left = kLimit;
  overlap(scene, geometry, states, 1, 0, budget);
  EXPECT_NEAR(budget.spent, kLimit, 1.0);
}

}  // namespace
}  // namespace mrhi
