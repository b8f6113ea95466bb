#include "overlap.h"

#include <algorithm>
#include <iterator>
#include <numeric>

#include "../text/text.h"
#include "neighbours.h"
#include "scene_geometry.h"

namespace mrhi {
namespace {

/// By the balls about their frames' origins.
bool are_near(const Body& a, const Body& b) {
  return (a.start.position - b.start.position).norm() < a.bounding_radius + b.bounding_radius;
}

bool are_joined(const Scene& scene, std::size_t a, std::size_t b) {
  const auto ia = static_cast<int>(a), ib = static_cast<int>(b);
  return std::any_of(scene.joints.begin(), scene.joints.end(), [&](const Joint& joint) {
    return (joint.parent == ia && joint.child == ib) || (joint.parent == ib && joint.child == ia);
  });
}

/// A body's union of shapes, as a place in world sees it.
struct Solid {
  const Body& body;
  const std::vector<ManifoldShape>& shapes;
  const Pose& pose;

  struct Depth {
    double depth;    // of the place below the surface, < 0 outside [m]
    Vector3 inward;  // unit, world
  };
  Depth at(const Vector3& place) const {
    constexpr double kFar = 1e3;  // [m]
    Depth deepest{-kFar, Vector3::UnitZ()};
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      const Pose in_world = pose * body.shapes[i].pose;
      const Vector3 local = in_world.to_local(place);
      const ClosestFeatures found = closest_on(shapes[i].shape, shapes[i].mesh, {local, local, 0.0}, kFar);
      if (-found.distance > deepest.depth)
        deepest = {-found.distance, in_world.orientation * Vector3(-found.normal)};
    }
    return deepest;
  }
};

/// Diameter of the largest ball found inside both bodies, a lower bound of their overlap [m].
///
/// The search starts from points all over the first body, its centre first, and moves into the body in which
/// it is less deep by half the difference of both depths, which leads to the middle of a layer between two
/// flat faces. A manifold's depth, between corners and edges, does not detect coinciding faces.
double common_ball(const Solid& a, const Solid& b) {
  constexpr int kAcross = 5, kMaxSteps = 16;
  const Eigen::AlignedBox3d box = box_around(a.body);
  double largest = 0.0;
  constexpr int kStarts = kAcross * kAcross * kAcross;
  for (int i = 0; i < kStarts; ++i) {
    const int start = (i + kStarts / 2) % kStarts;
    const int row = start / kAcross, layer = row / kAcross;
    const Vector3 part(start % kAcross, row % kAcross, layer);
    const Vector3 offset = (2.0 * part / (kAcross - 1) - Vector3::Ones()) * 0.9;
    Vector3 place = a.pose * Vector3(box.center() + offset.cwiseProduct(0.5 * box.sizes()));
    for (int step = 0; step < kMaxSteps; ++step) {
      const Solid::Depth in_a = a.at(place), in_b = b.at(place);
      largest = std::max(largest, 2.0 * std::min(in_a.depth, in_b.depth));
      const Solid::Depth& lesser = in_a.depth < in_b.depth ? in_a : in_b;
      const double to_inside = kOverlap - lesser.depth;  // from outside
      const double advance =
          std::max(0.5 * std::abs(in_a.depth - in_b.depth), lesser.depth < 0.0 ? to_inside : 0.0);
      if (advance < 1e-5) break;
      place += advance * lesser.inward;
    }
    if (largest > kOverlap) break;
  }
  return largest;
}

bool has_mesh(const Body& body) {
  return std::any_of(body.shapes.begin(), body.shapes.end(),
                     [](const PlacedShape& placed) { return std::holds_alternative<Mesh>(placed.shape); });
}

}  // namespace

/// The deepest point of all pairs of shapes. Each is of two shapes alone: a body that has several may have to
/// go farther to be out.
double overlap(const Scene& scene, const SceneGeometry& geometry, const std::vector<BodyState>& bodies,
               std::size_t a, std::size_t b) {
  double deepest = 0.0;
  if (has_mesh(scene.bodies[a]) || has_mesh(scene.bodies[b])) {
    const Solid of_a{scene.bodies[a], geometry.shapes[a], bodies[a].pose},
        of_b{scene.bodies[b], geometry.shapes[b], bodies[b].pose};
    const bool smaller = of_a.body.bounding_radius < of_b.body.bounding_radius;
    deepest = smaller ? common_ball(of_a, of_b) : common_ball(of_b, of_a);
    if (deepest > kOverlap) return deepest;
  }
  for (std::size_t i = 0; i < scene.bodies[a].shapes.size(); ++i) {
    for (std::size_t j = 0; j < scene.bodies[b].shapes.size(); ++j) {
      const Manifold manifold =
          body_manifold(geometry.shapes[a][i], bodies[a].pose * scene.bodies[a].shapes[i].pose,
                        geometry.shapes[b][j], bodies[b].pose * scene.bodies[b].shapes[j].pose, 0.0);
      for (const ManifoldPoint& point : manifold) deepest = std::max(deepest, point.depth);
    }
  }
  return deepest;
}

namespace {

/// For each body the first body of its mechanism, or Joint::kWorld for fixtures and all that joints connect
/// with them.
std::vector<int> mechanisms(const Scene& scene) {
  std::vector<int> first(scene.bodies.size());
  std::iota(first.begin(), first.end(), 0);
  for (std::size_t b = 0; b < first.size(); ++b)
    if (scene.bodies[b].fixed) first[b] = Joint::kWorld;
  for (const Joint& joint : scene.joints) {
    const int one = joint.parent == Joint::kWorld ? joint.parent : first[joint.parent],
              other = first[joint.child];
    std::replace(first.begin(), first.end(), std::max(one, other), std::min(one, other));
  }
  return first;
}

/// see(a, b, depth), until it returns false.
template <class See>
void each_overlap(const Scene& scene, bool in_mechanisms, const See& see) {
  if (in_mechanisms && scene.joints.empty()) return;
  const SceneGeometry geometry(scene);
  std::vector<BodyState> states;
  std::transform(scene.bodies.begin(), scene.bodies.end(), std::back_inserter(states), start_state);
  const std::vector<int> first = mechanisms(scene);
  for (std::size_t a = 0; a < scene.bodies.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const Body &one = scene.bodies[a], &other = scene.bodies[b];
      if ((one.fixed && other.fixed) || (first[a] == first[b]) != in_mechanisms || !are_near(one, other) ||
          are_joined(scene, a, b))
        continue;
      const double depth = overlap(scene, geometry, states, a, b);
      if (depth > kOverlap && !see(a, b, depth)) return;
    }
  }
}

}  // namespace

std::string overlaps_at_start(const Scene& scene) {
  constexpr int kNamed = 5;
  std::string all;
  int named = 0;
  each_overlap(scene, false, [&](std::size_t a, std::size_t b, double depth) {
    all += (all.empty() ? "'" : ", '") + scene.bodies[a].name + "' is " + text::number(depth) + " m in '" +
           scene.bodies[b].name + "'";
    return ++named < kNamed;
  });
  return all;
}

std::vector<std::pair<int, int>> overlaps_in_mechanisms(const Scene& scene) {
  std::vector<std::pair<int, int>> pairs;
  each_overlap(scene, true, [&](std::size_t a, std::size_t b, double) {
    pairs.emplace_back(static_cast<int>(a), static_cast<int>(b));
    return true;
  });
  return pairs;
}

}  // namespace mrhi
