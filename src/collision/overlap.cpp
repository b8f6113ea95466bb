#include "overlap.h"

#include <algorithm>

#include "../text/text.h"

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

std::vector<BodyState> start_states(const Scene& scene) {
  std::vector<BodyState> states;
  states.reserve(scene.bodies.size());
  for (const Body& body : scene.bodies) {
    states.emplace_back();
    states.back().pose = body.start;
  }
  return states;
}

}  // namespace

/// The deepest point of all pairs of shapes. Each is of two shapes alone: a body that has several may have to
/// go farther to be out.
double overlap(const Scene& scene, const SceneGeometry& geometry, const std::vector<BodyState>& bodies,
               std::size_t a, std::size_t b) {
  double deepest = 0.0;
  for (std::size_t i = 0; i < scene.bodies[a].shapes.size(); ++i) {
    for (std::size_t j = 0; j < scene.bodies[b].shapes.size(); ++j) {
      const Manifold manifold =
          body_manifold(geometry.shapes[a][i], bodies[a].pose * scene.bodies[a].shapes[i].pose,
                        geometry.shapes[b][j], bodies[b].pose * scene.bodies[b].shapes[j].pose, 0.0);
      for (int k = 0; k < manifold.count; ++k)
        deepest = std::max(deepest, manifold.points[static_cast<std::size_t>(k)].depth);
    }
  }
  return deepest;
}

std::string overlaps_at_start(const Scene& scene) {
  constexpr int kNamed = 5;
  const SceneGeometry geometry(scene);
  const std::vector<BodyState> states = start_states(scene);
  std::string all;
  int named = 0;
  for (std::size_t a = 0; a < scene.bodies.size() && named < kNamed; ++a) {
    for (std::size_t b = 0; b < a && named < kNamed; ++b) {
      const Body &one = scene.bodies[a], &other = scene.bodies[b];
      if ((one.fixed && other.fixed) || !are_near(one, other) || are_joined(scene, a, b)) continue;
      const double depth = overlap(scene, geometry, states, a, b);
      if (depth <= kOverlap) continue;
      all += (all.empty() ? "'" : ", '") + one.name + "' is " + text::number(depth) + " m in '" + other.name +
             "'";
      ++named;
    }
  }
  return all;
}

}  // namespace mrhi
