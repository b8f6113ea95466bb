#pragma once

#include <vector>

#include "mesh_surface.h"

namespace mrhi {

/// A tree over the faces and edges of a surface. Each node has a ball, a box (tighter for long thin faces)
/// and a slab (thin on a curved surface) around its parts, and a cone of their normals (spatialized normal
/// cones: Johnson & Cohen 2001).
class MeshTree {
 public:
  struct Node {
    Vector3 centre, half;  // of the box along the mesh's axes, and the centre of the ball
    double radius;
    Vector3 normal;
    double top, bottom;             // of the slab, from the centre, along the normal and against it
    double cos_spread, sin_spread;  // of the cone about the normal; cos -1 if it is no cone
    int first, count;               // parts of a leaf, or (count 0) the first of two children

    /// Parts are no nearer to the segment than this; negative if it may cut them.
    double distance(const Segment& segment) const;
    /// Squared distance of this node's box from a box along the mesh's axes: 0 if they overlap.
    double squared_gap(const Vector3& middle, const Vector3& half_size) const {
      return ((centre - middle).cwiseAbs() - half - half_size).cwiseMax(0.0).squaredNorm();
    }
    /// The planes of its parts are no less deep around both ends of the segment than this.
    double depth(const Segment& segment) const;
    /// False if no part is where a path along its normal leads from the segment's point that leaves last.
    bool may_be_exit(const Segment& segment) const;
  };

  /// Enough for any mesh: a stack of open nodes has at most one more than there are levels, halved by the
  /// median.
  static constexpr std::size_t kMaxLevels = 64;

  explicit MeshTree(const MeshSurface& surface);

  const Node& node(int index) const { return nodes_[index]; }
  /// i in first..first + count of a leaf: a face, or that many and an edge.
  int part(int i) const { return parts_[i]; }

  /// Visits nodes that it `admits(node)`, always in the same order; `see(part)` the parts of leaves.
  template <typename Admits, typename See>
  void visit(const Admits& admits, const See& see) const {
    std::array<int, kMaxLevels> open;
    std::size_t count = 0;
    open[count++] = 0;
    while (count > 0) {
      const Node& now = node(open[--count]);
      if (!admits(now)) continue;
      for (int i = now.first; i < now.first + now.count; ++i) see(part(i));
      if (now.count == 0) open[count++] = now.first + 1, open[count++] = now.first;
    }
  }

  /// Visits nodes with cost(node) <= limit(), the lesser first; `see(part)` the parts of leaves.
  template <typename Cost, typename Limit, typename See>
  void search(const Cost& cost, const Limit& limit, const See& see) const {
    struct Open {
      int node;
      double cost;
    };
    std::array<Open, kMaxLevels> open;
    std::size_t count = 0;
    open[count++] = {0, cost(node(0))};
    while (count > 0) {
      const Open next = open[--count];
      if (next.cost > limit()) continue;
      const Node& now = node(next.node);
      if (now.count > 0) {
        for (int i = now.first; i < now.first + now.count; ++i) see(part(i));
        continue;
      }
      Open near{now.first, cost(node(now.first))}, far{now.first + 1, cost(node(now.first + 1))};
      if (far.cost < near.cost) std::swap(near, far);
      if (far.cost <= limit()) open[count++] = far;
      if (near.cost <= limit()) open[count++] = near;
    }
  }

 private:
  void build(const MeshSurface& surface, int node, std::vector<Vector3>& centres, int first, int last);
  void bound(const MeshSurface& surface, Node& node, int first, int last) const;

  std::vector<Node> nodes_;
  std::vector<int> parts_;
};

/// A mesh prepared for contact: its surface, tree and parts.
struct MeshShape {
  explicit MeshShape(const TriangleMesh& mesh) : surface(mesh), tree(surface) {}

  MeshSurface surface;
  MeshTree tree;
};

}  // namespace mrhi
