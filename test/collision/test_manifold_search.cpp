#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "brute_force.h"
#include "mesh_shapes.h"
#include "placed_shapes.h"

namespace mrhi {
namespace {

constexpr double kMargin = 0.003;

/// The surface point farthest along a direction, in the shape's frame.
struct Farthest {
  Vector3 n;
  Vector3 operator()(const Sphere& s) const { return s.radius * n; }
  Vector3 operator()(const Box& b) const { return BoxShape{b.half_extents}.farthest(n); }
  Vector3 operator()(const Cylinder& c) const { return CylinderShape{c.radius, c.half_length}.farthest(n); }
  Vector3 operator()(const Pill& p) const {
    return p.radius * n + (n.z() < 0 ? -p.half_length : p.half_length) * Vector3::UnitZ();
  }
  template <typename Other>
  Vector3 operator()(const Other& shape) const {
    return shape.farthest(n);
  }
};

struct PlacedPair {
  Shape a, b;
  Pose pose_a, pose_b;

  static double reach(const Shape& shape, const Pose& pose, const Vector3& n) {
    const Vector3 local = pose.orientation.conjugate() * n;
    return local.dot(std::visit(Farthest{local}, shape));
  }
  /// Gap between the shapes along n, out of b.
  double gap(const Vector3& n) const {
    return n.dot(pose_a.position - pose_b.position) - reach(a, pose_a, n) - reach(b, pose_b, n);
  }

  /// The greatest gap found: `directions` at random, the best of them improved by random steps that shrink
  /// down to `finest` [rad].
  double search(Random& random, int directions, int climbs, double finest = 1e-8) const {
    std::vector<std::pair<double, Vector3>> tried;
    for (int i = 0; i < directions; ++i) {
      const Vector3 n = random.direction();
      tried.emplace_back(gap(n), n);
    }
    std::partial_sort(tried.begin(), tried.begin() + climbs, tried.end(),
                      [](const auto& x, const auto& y) { return x.first > y.first; });
    double best = -1e300;
    for (int i = 0; i < climbs; ++i)
      best = std::max(best, climb(random, tried[std::size_t(i)].second, finest));
    return best;
  }
  double climb(Random& random, Vector3 n, double finest) const {
    double best = gap(n);
    for (double step = 0.05; step > finest;) {
      bool better = false;
      for (int i = 0; i < 12; ++i) {
        const Vector3 next = (n + step * random.direction()).normalized();
        if (gap(next) > best) best = gap(next), n = next, better = true;
      }
      if (!better) step *= 0.6;
    }
    return best;
  }
};

Shape random_shape(Random& random) {
  const double r = random.between(0.01, 0.04), h = random.between(0.01, 0.04);
  if (random.below(5) == 0) return Sphere{r};
  if (random.below(5) == 0) return Pill{r, h};
  if (random.below(2) == 0) return Cylinder{r, h};
  return Box{{r, h, random.between(0.01, 0.04)}};
}

/// Random shapes that overlap by a few millimetres or nearly touch.
PlacedPair random_pair(Random& random) {
  PlacedPair pair{random_shape(random), random_shape(random), Pose(), Pose()};
  pair.pose_a.orientation = random_turn(random), pair.pose_b.orientation = random_turn(random);
  pair.pose_a.position = random.in_box(Vector3::Constant(0.2));
  pair.pose_b.position = pair.pose_a.position;
  const Vector3 away = random.direction();
  double near = 0.0, far = 0.2;
  const double gap = random.between(-0.004, 0.002);
  constexpr double kCoarse = 5e-3;  // [rad], 0.2 mm at these sizes, as fine as the bisection places the pair
  for (int i = 0; i < 10; ++i) {
    const double middle = 0.5 * (near + far);
    pair.pose_a.position = pair.pose_b.position + middle * away;
    (pair.search(random, 60, 1, kCoarse) < gap ? near : far) = middle;
  }
  return pair;
}

/// What the face's normal instead of the best may cost (body_manifold.h).
double allowed(double depth) {
  return 0.001 * std::abs(depth) + 3e-6;
}

TEST(ManifoldSearch, no_direction_separates_sooner_than_the_manifold_says) {
  Random random(11);
  int touching = 0;
  for (int i = 0; i < 1500 && !HasFailure(); ++i) {
    const PlacedPair pair = random_pair(random);
    const Manifold m = body_manifold(pair.a, pair.pose_a, pair.b, pair.pose_b, kMargin);
    double gap = pair.search(random, 600, 3);
    SCOPED_TRACE(i);
    if (m.count == 0) {
      if (gap < kMargin) gap = std::max(gap, pair.search(random, 100000, 30));
      EXPECT_GT(gap, kMargin - allowed(kMargin));
      continue;
    }
    ++touching;
    EXPECT_NEAR(m.normal.norm(), 1.0, 1e-12);
    // The manifold may know a better direction than the search has found.
    gap = std::max(gap, pair.gap(m.normal));
    if (deepest(m) < -gap - allowed(gap)) gap = std::max(gap, pair.search(random, 100000, 30));
    EXPECT_NEAR(deepest(m), -gap, allowed(gap));
    for (int k = 0; k < m.count; ++k) {
      const ManifoldPoint& p = m.points[std::size_t(k)];
      EXPECT_LE(p.depth, deepest(m));
      // Midway between the surfaces: half the depth inside either, but for rounding and the borders'
      // tolerance.
      const double in_a =
          PlacedPair::reach(pair.a, pair.pose_a, -m.normal) + m.normal.dot(p.point - pair.pose_a.position);
      const double in_b =
          PlacedPair::reach(pair.b, pair.pose_b, m.normal) - m.normal.dot(p.point - pair.pose_b.position);
      EXPECT_GE(in_a, 0.5 * p.depth - 1e-6);
      EXPECT_GE(in_b, 0.5 * p.depth - 1e-6);
    }
  }
  EXPECT_GT(touching, 1000);
}

TEST(ManifoldSearch, exchanging_the_bodies_turns_the_normal_round) {
  Random random(12);
  for (int i = 0; i < 4000 && !HasFailure(); ++i) {
    const PlacedPair pair = random_pair(random);
    const Manifold m = body_manifold(pair.a, pair.pose_a, pair.b, pair.pose_b, kMargin);
    const Manifold other = body_manifold(pair.b, pair.pose_b, pair.a, pair.pose_a, kMargin);
    SCOPED_TRACE(i);
    ASSERT_EQ(m.count, other.count);
    if (m.count == 0) continue;
    EXPECT_LT((m.normal + other.normal).norm(), 1e-7);
    EXPECT_NEAR(deepest(m), deepest(other), 1e-9);
  }
}

TEST(ManifoldSearch, depth_changes_no_faster_than_the_bodies_move) {
  Random random(13);
  for (int i = 0; i < 2000 && !HasFailure(); ++i) {
    PlacedPair pair = random_pair(random);
    const Vector3 velocity = random.direction(), spin = random.direction();
    const double step = 1e-6;
    double before = 0;
    for (int k = 0; k < 50; ++k) {
      const Manifold m = body_manifold(pair.a, pair.pose_a, pair.b, pair.pose_b, kMargin);
      SCOPED_TRACE(i);
      if (m.count == 0) break;
      // 1 um of translation and 10 urad about a centre that is 60 mm away at most; plus the tolerances of
      // faces.
      if (k > 0) {
        EXPECT_NEAR(deepest(m), before, step + 0.6e-6 + allowed(before));
      }
      before = deepest(m);
      pair.pose_a.position += step * velocity;
      pair.pose_a.orientation = turn(10 * step, spin) * pair.pose_a.orientation;
    }
  }
}

TEST(ManifoldSearch, mesh_of_a_box_is_the_box_across_a_gap_and_nearly_in_overlap) {
  Random random(14);
  const Vector3 half(0.03, 0.02, 0.015);
  const auto triangles = std::make_shared<TriangleMesh>(box_mesh(half));
  const Shape box = Box{half}, other = Box{{0.02, 0.025, 0.01}};
  const Shape shape = Mesh{triangles, "", Vector3::Ones()};
  const MeshCollider collider(*triangles);
  int overlaps = 0, right = 0;
  for (int i = 0; i < 10000; ++i) {
    const Pose pose{random.between(0.01, 0.06) * random.direction(), random_turn(random)};
    const Pose origin{Vector3::Zero(), random_turn(random)};
    const Manifold exact = body_manifold(box, pose, other, origin, 0.001);
    if (exact.count == 0 || deepest(exact) > 0.002) continue;
    const Manifold mesh = body_manifold({shape, &collider}, pose, other, origin, 0.001);
    const double difference = std::abs(deepest(mesh) - deepest(exact));
    if (deepest(exact) < 0) {
      EXPECT_LT(difference, allowed(0.001));
    } else {
      ++overlaps, right += difference < allowed(deepest(exact));
    }
  }
  EXPECT_GT(overlaps, 300);
  EXPECT_GT(right, 0.9 * overlaps);
}

/// A disc's mesh that lies on a box, 0.5 mm deep: every corner of its lower face touches.
Manifold disc_on_a_box(int corners) {
  std::vector<Eigen::Vector2d> outline;
  std::vector<std::array<int, 3>> fan;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2.0 * M_PI * i / corners;
    outline.emplace_back(0.03 * std::cos(angle), 0.03 * std::sin(angle));
    if (i > 1) fan.push_back({{0, i - 1, i}});
  }
  const auto triangles = std::make_shared<TriangleMesh>(prism(outline, fan, 0.01));
  const MeshCollider collider(*triangles);
  const Shape disc = Mesh{triangles, "", Vector3::Ones()}, box = Box{{0.05, 0.05, 0.01}};
  return body_manifold({disc, &collider}, {{0.0, 0.0, 0.0195}, Quaternion::Identity()}, box, Pose(), 0.001);
}

TEST(ManifoldSearch, mesh_with_more_touches_than_are_remembered_stands_like_one_with_few) {
  for (const int corners : {100, 500}) {
    SCOPED_TRACE(corners);
    const Manifold m = disc_on_a_box(corners);
    ASSERT_EQ(m.count, 4);
    EXPECT_NEAR(m.normal.z(), 1.0, 1e-9);
    EXPECT_NEAR(deepest(m), 0.0005, 1e-9);
    Vector3 middle = Vector3::Zero();
    for (int i = 0; i < m.count; ++i) {
      const ManifoldPoint& p = m.points[static_cast<std::size_t>(i)];
      EXPECT_NEAR(p.depth, 0.0005, 1e-9);
      EXPECT_NEAR(p.point.head<2>().norm(), 0.03, 1e-6);
      middle += 0.25 * p.point;
    }
    // It stands: the points go around its middle.
    EXPECT_LT(middle.head<2>().norm(), 0.006);
  }
}

}  // namespace
}  // namespace mrhi
