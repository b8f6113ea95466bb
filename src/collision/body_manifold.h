#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "mesh_collision.h"
#include "mr_hand_interaction/scene/shape.h"

namespace mrhi {

/// One place where two bodies touch.
struct ManifoldPoint {
  Vector3 point;            ///< world, midway between the two surfaces
  double depth;             ///< along the manifold's normal: > 0 overlap, < 0 gap [m]
  std::uint8_t feature;     ///< names the corners, edges or rims that meet; the same from step to step
  std::uint8_t region = 0;  ///< of the surface, with a normal of its own
};

/// Contact points of two shapes, none beyond the margin. Only non-convex meshes touch in several regions, as
/// a die in a cup touches floor and wall; the first region has the deepest point, the others overlap.
struct Manifold {
  static constexpr int kMaxRegions = 3;
  Vector3 normal = Vector3::UnitZ();  ///< unit, world, out of b towards a: moving a along it separates
  std::array<Vector3, kMaxRegions - 1> other_normals{};  ///< of the further regions, likewise
  std::array<ManifoldPoint, 4 * kMaxRegions> points;
  int count = 0;

  Manifold() = default;
  Manifold(const Manifold& other) { *this = other; }
  /// Copies the points that there are.
  Manifold& operator=(const Manifold& other) {
    normal = other.normal;
    other_normals = other.other_normals;
    count = other.count;
    breadth = other.breadth;
    std::copy_n(other.points.begin(), count, points.begin());
    return *this;
  }
  const Vector3& normal_of(int region) const { return region == 0 ? normal : other_normals[region - 1]; }
  ManifoldPoint* begin() { return points.data(); }
  ManifoldPoint* end() { return points.data() + count; }
  const ManifoldPoint* begin() const { return points.data(); }
  const ManifoldPoint* end() const { return points.data() + count; }
  /// There must be points.
  const ManifoldPoint& deepest() const {
    return *std::max_element(begin(), end(), [](const auto& x, const auto& y) { return x.depth < y.depth; });
  }
  int count_of(int region) const {
    return static_cast<int>(
        std::count_if(begin(), end(), [=](const auto& point) { return point.region == region; }));
  }
  /// Breadth of the strip in which two prisms touch, across the normal; unlimited for other shapes [m].
  double breadth = 1e300;
};

/// A shape with what contact queries need of it, made once at loading. Refers to what it is made of; throws
/// std::invalid_argument for a mesh without its collider. Queries are in the shape's frame.
struct ManifoldShape {
  ManifoldShape(const Shape& placed, const MeshCollider* collider = nullptr);

  /// Closest features of a capsule, if nearer than `margin`: closed form or mesh.
  std::optional<ClosestFeatures> closest(const Capsule& capsule, double margin) const;
  AxisSpan span(const Capsule& capsule, const ClosestFeatures& features) const {
    return mesh != nullptr ? mesh->span(capsule, features) : contact_span(capsule, shape, features);
  }

  const Shape& shape;
  const MeshCollider* mesh;
  std::optional<Capsule> core;     ///< if it is a ball or a capsule
  std::optional<PrismForm> prism;  ///< if it is a box or a cylinder
  double bounding_radius;          ///< about the shape frame's origin [m]
};

constexpr double kAnyBreadth = -1e300;  ///< [m]

/// Work of a search that found the surface of `shape` at this distance [m], in ordinary searches of a mesh
/// (1 to 2 us each).
double search_work(const ManifoldShape& shape, double distance);

/// Index of the i-th sample of `count` parts, spaced by the golden ratio: even wherever the sample ends.
std::size_t sampled(std::size_t i, std::size_t count);

/// Limit of the work of meshes' manifolds, as of search_work(). A pair that would exceed it has fewer contact
/// points, spread over those found and a sample of its edges.
struct SearchBudget {
  /// Of a pair, including its sweep through a step, and of all pairs of a step; without samples.
  static constexpr double kPair = 2500.0, kStep = 3000.0;
  /// Of a mesh's sample, and once the step's budget is exhausted.
  static constexpr double kSample = 300.0, kMinSample = 30.0;

  double left = kPair;
  double sample = kSample;
  double spent = 0.0;  // samples included

  void spend(double work) { left -= work, spent += work; }
  /// What a pair may spend if others have spent so much in this step.
  static SearchBudget after(double spent) {
    const double left = kStep - spent;
    return {left < kPair ? left : kPair, left > 0.0 ? kSample : kMinSample};
  }
};

/// Manifold of shapes in world that overlap or are within `margin` >= 0 [m]: at most 4 points, the deepest
/// among them. Two prisms that overlap by less than `least_breadth` in two directions across each other, like
/// diagonal neighbours of a stack, do not touch.
///
/// Depth is the shortest separating translation, to rounding; within 2.5 degrees of a face's normal it is
/// along that (of two faces the larger one's), so that a body on a face keeps its normal and points: within
/// 0.1 % + 3 um. A rim cut deeper than it is curved there may be 1 % too deep. For meshes see
/// mesh_manifold().
Manifold body_manifold(const ManifoldShape& a, const Pose& pose_a, const ManifoldShape& b, const Pose& pose_b,
                       double margin, double least_breadth = kAnyBreadth, SearchBudget* budget = nullptr);

/// A ball or a capsule, in the frame `pose_a`, against any shape: two points where it lies along a flat or
/// straight surface (named 0 and 1, by the ends of its axis), otherwise one (0 or 1 at an end, 2 between).
Manifold core_manifold(const Capsule& core, const Pose& pose_a, const ManifoldShape& b, const Pose& pose_b,
                       double margin);

/// Two prisms, by the direction of least overlap: near a face's normal by clipping the other to that face
/// (Sutherland & Hodgman 1974), otherwise by the lines or the point that face each other.
Manifold prism_manifold(const ManifoldShape& a, const Pose& pose_a, const ManifoldShape& b,
                        const Pose& pose_b, double margin, double least_breadth);

/// A mesh against a box, a cylinder or a mesh: corners and edges of each are measured in the other. The
/// deepest gives the normal; of those with nearly that normal, the outermost in eight directions are the
/// further points. Corners and edges are those of flat faces, however a file cuts these into triangles.
///
/// Exact across a gap, and where a corner overlaps a face. An edge or a corner that overlaps another alone
/// counts with its own depth, which may be less than the bodies have to move. Meshes of boxes at random poses
/// with up to 2 mm of overlap: within 0.1 % in nine of ten, up to 70 % too shallow in one of a hundred. An
/// edge along a face is represented by its middle and its corners, a cylinder by eight points of its rims and
/// the side line that faces the mesh. Names are numbers of corners modulo 100 and of edges modulo 28.
Manifold mesh_manifold(const ManifoldShape& a, const Pose& pose_a, const ManifoldShape& b, const Pose& pose_b,
                       double margin, SearchBudget& budget);

}  // namespace mrhi
