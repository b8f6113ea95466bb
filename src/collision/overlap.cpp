#include "overlap.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>
#include <type_traits>

#include "../scene/solid_mesh.h"
#include "../text/text.h"
#include "mesh_tree.h"
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

/// About a body, in its frame. Of meshes their colliders know the box: fine ones have many vertices.
Eigen::AlignedBox3d quick_box(const Body& body, const std::vector<PlacedCollider>& shapes) {
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const Pose& pose = shapes[i].pose;
    if (shapes[i].mesh == nullptr) {
      box.extend(box_around(body.shapes[i]));
      continue;
    }
    const Eigen::AlignedBox3d& own = shapes[i].mesh->shape().surface.bounds();
    const Vector3 centre = pose * Vector3(own.center()),
                  half = 0.5 * (pose.orientation.toRotationMatrix().cwiseAbs() * own.sizes());
    box.extend(Eigen::AlignedBox3d(centre - half, centre + half));
  }
  return box;
}

/// True if a plane along the faces of one of the boxes about two bodies separates them.
bool are_apart(const Eigen::AlignedBox3d& a, const Pose& pose_a, const Eigen::AlignedBox3d& b,
               const Pose& pose_b) {
  const auto is_beyond = [](const Eigen::AlignedBox3d& box, const Pose& pose,
                            const Eigen::AlignedBox3d& other, const Pose& other_pose) {
    const Matrix3 turn = (pose.orientation.conjugate() * other_pose.orientation).toRotationMatrix();
    const Vector3 centre = pose.to_local(other_pose * Vector3(other.center()));
    const Vector3 apart =
        (centre - box.center()).cwiseAbs() - 0.5 * box.sizes() - 0.5 * (turn.cwiseAbs() * other.sizes());
    return apart.maxCoeff() > 0.0;
  };
  return is_beyond(a, pose_a, b, pose_b) || is_beyond(b, pose_b, a, pose_a);
}

/// A body's union of shapes, as a place in world sees it.
struct Solid {
  const Body& body;
  const std::vector<PlacedCollider>& shapes;
  const Pose& pose;
  SearchBudget& budget;

  struct Depth {
    double depth;    // of the place below the surface, < 0 outside [m]
    Vector3 inward;  // unit, world
  };
  Depth at(const Vector3& place) const {
    constexpr double kMaxDistance = 1e3;  // [m]
    Depth deepest{-kMaxDistance, Vector3::UnitZ()};
    for (const PlacedCollider& shape : shapes) {
      const Pose in_world = pose * shape.pose;
      const Vector3 local = in_world.to_local(place);
      const auto found = shape.closest({local, local, 0.0}, kMaxDistance);
      budget.spend(search_work(shape, found ? found->distance : kMaxDistance));
      if (found && -found->distance > deepest.depth)
        deepest = {-found->distance, in_world.orientation * Vector3(-found->normal)};
    }
    return deepest;
  }
};

/// Diameter of the largest ball found inside both bodies, a lower bound of their overlap [m].
/// The search starts from points all over the first body, and moves into the body in which it is less deep by
/// half the difference of both depths: to the middle of a layer between two flat faces. It begins beside the
/// centre, as from there a round surface is equally near everywhere, which makes searches slow. A manifold's
/// depth, between corners and edges, does not detect coinciding faces.
double common_ball(const Solid& a, const Solid& b) {
  constexpr int kAcross = 5, kMaxSteps = 16;
  const Eigen::AlignedBox3d box = quick_box(a.body, a.shapes);
  double largest = 0.0;
  constexpr int kStarts = kAcross * kAcross * kAcross;
  for (int i = 0; i < kStarts; ++i) {
    const int start = (i + kStarts / 2) % kStarts;
    const int row = start / kAcross, layer = row / kAcross;
    const Vector3 part(start % kAcross, row % kAcross, layer);
    const Vector3 beside = start == kStarts / 2 ? Vector3(0.31, 0.17, 0.23) : Vector3(0, 0, 0);
    const Vector3 offset = (2.0 * part / (kAcross - 1) - Vector3::Ones()) * 0.9 + beside;
    Vector3 place = a.pose * Vector3(box.center() + offset.cwiseProduct(0.5 * box.sizes()));
    for (int step = 0; step < kMaxSteps; ++step) {
      if (a.budget.left <= 0.0) return largest;
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

/// Half of the largest wall that is thin [m]. In those of kOverlap and more, common_ball() finds what two
/// bodies share.
constexpr double kMaxHalfWall = 0.55 * kOverlap;

/// Whether the wall behind a place on the surface of `solid` lies in the other body; nothing if it is thick.
/// The place moves inwards while it gets deeper, to the middle of the wall. On an open surface it must itself
/// lie on the other's.
std::optional<bool> is_wall_shared(const Solid& solid, const Vector3& place, const Vector3& inward,
                                   bool is_closed, const Solid& other) {
  constexpr int kSteps = 5;
  constexpr double kMinDepthRatio = 0.95, kCoincidence = 1e-6;  // ratio, [m]
  if (!is_closed) return std::abs(other.at(place).depth) < kCoincidence;
  double depth = 0.0;
  for (int step = 1; step <= kSteps; ++step) {
    const double next = step * kMaxHalfWall / kSteps;
    if (solid.at(place + next * inward).depth < kMinDepthRatio * next) break;
    if (step == kSteps) return std::nullopt;
    depth = next;
  }
  if (depth == 0.0) return std::nullopt;
  return other.at(place + depth * inward).depth > 0.5 * depth;
}

/// Whether most places lie in the other body, of those of which is_shared(k) knows it.
template <class IsShared>
bool most_are_shared(int least_known, const SearchBudget& budget, const IsShared& is_shared) {
  constexpr int kSamples = 24;
  int known = 0, shared = 0;
  for (int k = 0; k < kSamples && budget.left > 0.0; ++k) {
    const std::optional<bool> found = is_shared(static_cast<std::size_t>(k));
    if (!found) continue;
    ++known;
    if (*found) ++shared;
  }
  return known >= least_known && 2 * shared > known;
}

/// True if most of a mesh's thin walls lie in the other body. Walls are sampled at its triangles.
bool shares_walls_of_mesh(const Solid& solid, const PlacedCollider& shape, const Solid& other) {
  constexpr int kMinThinWalls = 12;
  const TriangleMesh& mesh = *std::get<Mesh>(shape.shape).triangles;
  const bool is_closed = shape.mesh->shape().surface.closed();
  const Pose in_world = solid.pose * shape.pose;
  return most_are_shared(kMinThinWalls, solid.budget, [&](std::size_t k) -> std::optional<bool> {
    const auto& triangle = mesh.triangles[sampled(k, mesh.triangles.size())];
    const Vector3 &first = mesh.vertices[triangle[0]], &second = mesh.vertices[triangle[1]],
                  &third = mesh.vertices[triangle[2]];
    const Vector3 normal = (second - first).cross(third - first);
    if (normal.isZero(0.0)) return std::nullopt;
    const Vector3 inward = -(in_world.orientation * Vector3(normal.normalized()));
    return is_wall_shared(solid, in_world * Vector3((first + second + third) / 3.0), inward, is_closed,
                          other);
  });
}

/// Half of a shape's least breadth; a mesh's is not known [m].
double least_half(const ManifoldShape& shape) {
  if (shape.core) return shape.core->radius;
  return shape.prism ? shape.prism->half.minCoeff() : shape.bounding_radius;
}

bool is_thin(const ManifoldShape& shape) {
  return shape.mesh == nullptr && least_half(shape) < kMaxHalfWall;
}

/// True if most of the middle of a thin shape lies in the other body.
bool shares_middle(const Solid& solid, const PlacedCollider& shape, const Solid& other) {
  constexpr double kNearEnds = 0.7;
  const Vector3 spacing(0.8191725134, 0.6710436067, 0.5497004779);  // evenly spread (Roberts 2018)
  const double thin = least_half(shape);
  const Pose in_world = solid.pose * shape.pose;
  return most_are_shared(1, solid.budget, [&](std::size_t k) -> std::optional<bool> {
    const Vector3 turns = static_cast<double>(k) * spacing;
    const Vector3 part = kNearEnds * (2.0 * (turns.array() - turns.array().floor()) - 1.0);
    Vector3 place = Vector3::Zero();
    if (shape.core) {
      place = shape.core->axis_point(0.5 + 0.5 * part.x());
    } else {
      // Of a plate its middle plane, of a rod its axis.
      for (int axis = 0; axis < 3; ++axis)
        if (shape.prism->half[axis] > thin) place[axis] = part[axis] * shape.prism->half[axis];
    }
    return other.at(in_world * place).depth > 0.5 * thin;
  });
}

/// True if most of the first body's thin walls lie in the other.
bool shares_walls(const Solid& solid, const Solid& other) {
  return std::any_of(solid.shapes.begin(), solid.shapes.end(), [&](const PlacedCollider& shape) {
    return shape.mesh != nullptr ? shares_walls_of_mesh(solid, shape, other)
                                 : is_thin(shape) && shares_middle(solid, shape, other);
  });
}

/// The shape without the layer of this depth below its surface; a mesh as it is.
Shape without_layer(const Shape& shape, double depth) {
  return std::visit(
      [depth](auto inner) -> Shape {
        using Kind = decltype(inner);
        if constexpr (std::is_same_v<Kind, Box>) {
          inner.half_extents.array() -= depth;
        } else if constexpr (!std::is_same_v<Kind, Mesh>) {
          inner.radius -= depth;
          if constexpr (std::is_same_v<Kind, Cylinder>) inner.half_length -= depth;
        }
        return inner;
      },
      shape);
}

/// True if two shapes, at least one of them thin, still overlap after a layer is removed from the surface of
/// each: a quarter of a thin shape's thickness, at most kOverlap / 2. Thin plates that cross have less depth
/// than kOverlap.
bool cross_each_other(const PlacedCollider& one, const Pose& pose_one, const PlacedCollider& other,
                      const Pose& pose_other) {
  if (one.mesh != nullptr || other.mesh != nullptr || !(is_thin(one) || is_thin(other))) return false;
  const auto inner = [](const ManifoldShape& shape) {
    return without_layer(shape.shape, 0.5 * std::min(kOverlap, least_half(shape)));
  };
  const Shape inner_one = inner(one), inner_other = inner(other);
  const Manifold manifold =
      body_manifold(ManifoldShape(inner_one), pose_one, ManifoldShape(inner_other), pose_other, 0.0);
  return manifold.count > 0 && manifold.deepest().depth > 0.0;
}

bool has_mesh(const Solid& solid) {
  return std::any_of(solid.shapes.begin(), solid.shapes.end(),
                     [](const PlacedCollider& shape) { return shape.mesh != nullptr; });
}

}  // namespace

/// The deepest point of all pairs of shapes; a body of several may have to move farther.
Overlap overlap(const Scene& scene, const SceneGeometry& geometry, const std::vector<BodyState>& bodies,
                std::size_t a, std::size_t b, SearchBudget& budget) {
  Overlap found;
  const Solid of_a{scene.bodies[a], geometry.colliders[a], bodies[a].pose, budget},
      of_b{scene.bodies[b], geometry.colliders[b], bodies[b].pose, budget};
  if (are_apart(quick_box(of_a.body, of_a.shapes), of_a.pose, quick_box(of_b.body, of_b.shapes), of_b.pose))
    return found;
  if (has_mesh(of_a) || has_mesh(of_b)) {
    const bool smaller = of_a.body.bounding_radius < of_b.body.bounding_radius;
    const Solid &first = smaller ? of_a : of_b, &second = smaller ? of_b : of_a;
    constexpr double kWallFraction = 0.3;  // of the budget
    const double for_walls = kWallFraction * budget.left;
    budget.left -= for_walls;
    found.depth = common_ball(first, second);
    budget.left += for_walls;
    if (found.depth > kOverlap) return found;
    found.shares_walls = shares_walls(first, second) || shares_walls(second, first);
    if (found.shares_walls) return found;
  }
  for (const PlacedCollider& one : of_a.shapes) {
    const Pose pose_one = of_a.pose * one.pose;
    for (const PlacedCollider& other : of_b.shapes) {
      const Pose pose_other = of_b.pose * other.pose;
      const double reach = one.bounding_radius + other.bounding_radius;
      if ((pose_one.position - pose_other.position).squaredNorm() > reach * reach) continue;
      if (budget.left <= 0.0) return found;
      constexpr double kManifold = 0.3;  // searches
      budget.spend(kManifold);
      const Manifold manifold = body_manifold(one, pose_one, other, pose_other, 0.0, kAnyBreadth, &budget);
      for (const ManifoldPoint& point : manifold) {
        if (point.depth <= found.depth) continue;
        found.depth = point.depth;
        found.apart = point.depth * manifold.normal_of(point.region);
      }
      found.shares_walls =
          found.shares_walls || (manifold.count > 0 && cross_each_other(one, pose_one, other, pose_other));
    }
  }
  return found;
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

/// The bodies of a scene where they start.
struct StartingBodies {
  explicit StartingBodies(const Scene& of) : scene(of), geometry(of), first(mechanisms(of)) {
    std::transform(of.bodies.begin(), of.bodies.end(), std::back_inserter(states), start_state);
  }

  /// see(a, b, overlap) for pairs that overlap, until it returns false. Returns the work of searches.
  template <class See>
  double each_overlap(bool in_mechanisms, const See& see, double searches = 1e300) const {
    double work = 0.0;
    for (std::size_t a = 0; a < scene.bodies.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        const Body &one = scene.bodies[a], &other = scene.bodies[b];
        if ((one.fixed && other.fixed) || (first[a] == first[b]) != in_mechanisms || !are_near(one, other) ||
            are_joined(scene, a, b))
          continue;
        constexpr double kMaxSearches = 2e5;
        SearchBudget budget;
        budget.left = std::clamp(searches - work, SearchBudget::kMinSample, kMaxSearches);
        const Overlap found = overlap(scene, geometry, states, a, b, budget);
        work += budget.spent;
        if ((found.depth > 0.0 || found.shares_walls) && !see(a, b, found)) return work;
      }
    }
    return work;
  }

  const Scene& scene;
  const SceneGeometry geometry;
  const std::vector<int> first;
  std::vector<BodyState> states;
};

}  // namespace

std::string overlaps_at_start(const Scene& scene, double searches) {
  constexpr int kMaxNamed = 5;
  std::string all;
  int named = 0;
  const auto name = [&](std::size_t a, std::size_t b, const Overlap& found) {
    if (found.is_allowed()) return true;
    all += (all.empty() ? "'" : ", '") + scene.bodies[a].name + "' is " +
           (found.shares_walls ? "inside thin walls of '" : text::number(found.depth) + " m in '") +
           scene.bodies[b].name + "'";
    return ++named < kMaxNamed;
  };
  StartingBodies(scene).each_overlap(false, name, searches);
  return all;
}

// Pair by pair, half by each of two that may move, until none overlaps: a row spreads from its ends.
std::vector<double> part_at_start(Scene& scene) {
  constexpr double kTouching = 1e-7;  // [m]: rounding of a file's numbers
  constexpr int kMaxRounds = 200;
  constexpr double kMaxWork = 1e6;  // searches, a second or two
  StartingBodies starting(scene);
  const auto move = [&](std::size_t body, const Vector3& by) {
    scene.bodies[body].start.position += by;
    starting.states[body].pose.position = scene.bodies[body].start.position;
  };
  const std::vector<BodyState> before = starting.states;
  double work = 0.0;
  bool moved = true;
  for (int round = 0; moved && round < kMaxRounds && work < kMaxWork; ++round) {
    moved = false;
    work += starting.each_overlap(false, [&](std::size_t a, std::size_t b, const Overlap& found) {
      const bool a_moves = scene.bodies[a].flies, b_moves = scene.bodies[b].flies;
      if (found.depth <= kTouching || !(a_moves || b_moves)) return true;
      const Vector3 apart = (a_moves && b_moves ? 0.5 : 1.0) * found.apart;
      if (a_moves) move(a, apart);
      if (b_moves) move(b, -apart);
      moved = moved || apart != Vector3::Zero();
      return true;
    });
  }
  std::vector<double> distances;
  for (std::size_t b = 0; b < before.size(); ++b)
    distances.push_back((starting.states[b].pose.position - before[b].pose.position).norm());
  return distances;
}

std::vector<std::pair<int, int>> overlaps_in_mechanisms(const Scene& scene) {
  std::vector<std::pair<int, int>> pairs;
  if (scene.joints.empty()) return pairs;
  StartingBodies(scene).each_overlap(true, [&](std::size_t a, std::size_t b, const Overlap& found) {
    if (!found.is_allowed()) pairs.emplace_back(static_cast<int>(a), static_cast<int>(b));
    return true;
  });
  return pairs;
}

}  // namespace mrhi
