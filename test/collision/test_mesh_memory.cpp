#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "collision/mesh_collision.h"
#include "mesh_shapes.h"
#include "random_capsules.h"
#include "support/tessellated.h"

namespace mrhi {
namespace {

/// A ball with its top pushed in, a ring, an angle and a plain ball: hollow and not, fine and coarse.
std::vector<TriangleMesh> meshes() {
  TriangleMesh dented = testing::tessellated_ball(0.025, 40);
  for (Vector3& v : dented.vertices)
    if (v.z() > 0.01) v.z() = 0.02 - v.z();
  return {dented, testing::tessellated_ring(0.017, 0.008, 40), angle_mesh(),
          testing::tessellated_ball(0.025, 60)};
}

void expect_same(const std::optional<ClosestFeatures>& a, const std::optional<ClosestFeatures>& b) {
  ASSERT_EQ(a.has_value(), b.has_value());
  if (!a) return;
  EXPECT_EQ(a->distance, b->distance);
  EXPECT_EQ(a->normal, b->normal);
  EXPECT_EQ(a->point, b->point);
  EXPECT_EQ(a->axis_parameter, b->axis_parameter);
  EXPECT_EQ(a->face, b->face);
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
