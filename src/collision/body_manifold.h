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

/// Contact points of two shapes. Empty if they are farther apart than the margin. Only non-convex meshes
/// touch in several regions at once, as a die in a cup touches floor and wall; the first region has the
/// deepest point, the others overlap.
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
  /// Overlap of two prisms across the normal: the breadth of the strip in which they touch; unlimited of
  /// other shapes [m].
  double breadth = 1e300;
};

/// A shape as the manifold needs it: made once at loading. Refers to what it is made of; throws
/// std::invalid_argument for a mesh without its collider.
struct ManifoldShape {
  ManifoldShape(const Shape& placed, const MeshCollider* collider = nullptr);

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

/// Index of the i-th of a sample of `count` parts: at the fractional part of i times the golden ratio, so
/// that the sample is even wherever it ends.
std::size_t sampled(std::size_t i, std::size_t count);

/// Work that manifolds of meshes may take, as of search_work(). A pair that would
/// exceed it has fewer contact points, spread over what was found and a sample of its edges.
struct SearchBudget {
  /// Of a pair, whose sweep through a step is included, and of all pairs of a step, samples not included.
  static constexpr double kPair = 2500.0, kStep = 3000.0;
  /// Of a mesh's sample, and once the step's budget is exhausted.
  static constexpr double kSample = 300.0, kLeastSample = 30.0;

  double left = kPair;
  double sample = kSample;
  double spent = 0.0;  // samples included

  void spend(double work) { left -= work, spent += work; }
  /// What a pair may spend if others have spent so much in this step.
  static SearchBudget after(double spent) {
    const double left = kStep - spent;
    return {left < kPair ? left : kPair, left > 0.0 ? kSample : kLeastSample};
  }
};

/// Manifold of the shapes, placed in world, that overlap or are within `margin` >= 0 [m]: at most 4 points,
/// the deepest among them. Deterministic; no memory, no allocation. Two prisms that overlap by less than
/// `least_breadth` in two directions across each other, like diagonal neighbours of a stack, do not touch.
///
/// Sphere, box and cylinder with each other: the deepest point is as deep as the shortest translation that
/// separates them, to rounding. Where that is within 2.5 degrees of a face's normal, the face's is taken (the
/// larger face's, if two meet), so that what lies on a face keeps its normal and its points: right to 0.1 % +
/// 3 um. A ball or a capsule with any shape: to rounding, at two points where it lies along a face or a
/// straight side. A rim cut deeper than it is curved there may be taken 1 % too deep. Mesh: corners and edges
/// of each are measured in the other; mesh_manifold() says how well.
Manifold body_manifold(const ManifoldShape& a, const Pose& pose_a, const ManifoldShape& b, const Pose& pose_b,
                       double margin, double least_breadth = kAnyBreadth, SearchBudget* budget = nullptr);

/// Closest features of a capsule in the shape's frame, if nearer than `margin`: closed form or mesh.
std::optional<ClosestFeatures> closest_on(const ManifoldShape& shape, const Capsule& capsule, double margin);

/// A ball or a capsule, given in the frame `pose_a`, against any shape: at two points where it lies along
/// something flat or straight (named 0 and 1, by the ends of its axis), otherwise at one (also 0 or 1 at an
/// end, 2 between). Within 2.5 degrees of a face over which part of it stands, by that face.
Manifold core_manifold(const Capsule& core, const Pose& pose_a, const ManifoldShape& b, const Pose& pose_b,
                       double margin);

/// Two prisms (a box and a box, a cylinder and a box, ...), by the direction of least overlap: where that is
/// near a face's normal, by that face, what is over it clipped by Sutherland & Hodgman 1974; otherwise by the
/// lines or the point that face each other.
Manifold prism_manifold(const ManifoldShape& a, const Pose& pose_a, const ManifoldShape& b,
                        const Pose& pose_b, double margin, double least_breadth);

/// A mesh against a box, a cylinder or a mesh: corners and edges of each are measured in the other, the
/// deepest gives the normal, and of those that agree with it the farthest out in eight directions are the
/// further points. A mesh's tree leaves out what cannot be one of these. Corners and edges are those of its
/// flat faces: how many triangles a file has for them, and in which order, changes nothing. Exact across a
/// gap, and where a corner overlaps a face; an edge or a corner that overlaps another's by itself counts as
/// deep as it is itself, which may be less than what the bodies have to move. Meshes of boxes at random poses
/// with up to 2 mm of overlap: right to 0.1 % in nine of ten, up to 70 % too shallow in one of a hundred.
/// Where an edge lies along a face, its middle and its corners stand for it: a mesh that overhangs a table
/// touches with the corners that are on it and the middle of the table's edge. A cylinder touches with eight
/// points of its rims and the side line that faces the mesh. Names are numbers of corners modulo 100 and of
/// edges modulo 28. Beyond the budget, contacts are chosen from a subset: those found until then, thinned
/// evenly, and those of a sample of edges.
Manifold mesh_manifold(const ManifoldShape& a, const Pose& pose_a, const ManifoldShape& b, const Pose& pose_b,
                       double margin, SearchBudget& budget);

}  // namespace mrhi
