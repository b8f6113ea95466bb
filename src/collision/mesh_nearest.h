#pragma once

#include "closest_features.h"
#include "mesh_surface.h"
#include "mesh_tree.h"

namespace mrhi {

/// Parts that may be nearest to a segment whose ends are within `margin` of the given ones. All others are
/// farther.
struct NearParts {
  static constexpr std::size_t kCapacity = 40;

  Vector3 start = Vector3::Zero(), end = Vector3::Zero();
  double margin = 0.0;  // [m]; 0: nothing is known
  std::array<int, kCapacity> parts;
  std::size_t count = 0;

  /// Larger distance of the segment's ends from the given ones.
  double moved(const Segment& segment) const {
    return std::sqrt(std::max((segment.start - start).squaredNorm(), (segment.end() - end).squaredNorm()));
  }
};

/// The part of a surface that is nearest to a segment, within a range. Faces come before the edges around
/// them, and of equally near parts the first: the result does not depend on where the search began. A face is
/// only nearest by its inside; kSameDistance lets it win over an edge that rounding makes nearer by an ulp.
class MeshNearest {
 public:
  /// `guess` is a part to begin with, or -1. Above a convex solid a right guess needs no search.
  MeshNearest(const MeshSurface& surface, const MeshTree& tree, const Segment& segment, double range,
              int guess);

  /// The same where `near` holds for the segment: without a search.
  MeshNearest(const MeshSurface& surface, const Segment& segment, double range, const NearParts& near);

  /// Parts that may be nearest while the ends move by at most its margin.
  NearParts near_parts(const MeshTree& tree) const;

  bool found() const { return nearest().distance <= range_; }
  const SurfaceNearest& nearest() const {
    return on_face_.distance <= on_edge_.distance + kSameDistance ? on_face_ : on_edge_;
  }
  /// The nearest part, as the tree names it, or another near it if nothing is within the range.
  int part() const { return on_face_.distance <= on_edge_.distance + kSameDistance ? face_ : edge_; }
  /// Nodes and parts that the search has looked at.
  int visits() const { return visits_; }
  /// From the surface to the segment.
  Vector3 gap() const { return segment_.at(nearest().stretch.middle()) - nearest().point; }

 private:
  static constexpr double kSameDistance = 1e-14, kAnyDistance = 1e300;

  /// Calls `see(part)` for parts of nodes that are no farther from the segment than limit(), the nearer nodes
  /// first.
  template <typename Limit, typename See>
  void visit(const MeshTree& tree, const Limit& limit, const See& see) const;
  bool is_all() const;
  void search(const MeshTree& tree, double range);
  bool is_below(const MeshTree::Node& node, double limit) const;
  bool is_too_far(int part, double limit) const;
  SurfaceNearest measured(int part) const;
  void measure(int part, double range);
  void face_nearest();
  double limit(double range) const {
    return std::min(range, std::min(on_face_.distance, on_edge_.distance)) + 1e-12;
  }

  const MeshSurface& surface_;
  const Segment& segment_;
  const double range_;
  const int faces_;
  SurfaceNearest on_face_, on_edge_;
  int face_ = -1, edge_ = -1;
  int visits_ = 0;
  Vector3 facing_ = Vector3::Zero();  // unit, from the nearest so far to the segment
  double min_height_ = 0.0;           // that any of the segment reaches along it
};

/// The shortest translation that takes a segment, which cuts the surface or lies inside, out by a face or a
/// convex edge; distance <= 0. Exact for a convex mesh. Elsewhere the exit must lead through the face or edge
/// itself, whatever the segment meets farther on; without one it is the plane of the face `fallback`. `known`
/// is the result unless there is a shorter exit.
ClosestFeatures leave_mesh(const Segment& segment, const MeshSurface& surface, const MeshTree& tree,
                           int fallback, const ClosestFeatures* known = nullptr);

}  // namespace mrhi
