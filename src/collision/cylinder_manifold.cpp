#include "pair_manifolds.h"

#include <algorithm>

#include "convex_axis.h"
#include "flat_contact.h"

namespace mrhi {
namespace {

/// An edge or a side faces a direction that is across it by this.
constexpr double kFaces = 1e-6, kAlmostFaces = 0.01;
/// Names of what touches with neither cap nor face.
constexpr int kEdgeOrCorner = 160, kSides = 200;

/// What the shape has straight across a direction, farthest along it; the edge along `beside`, if there are
/// two.
Line line_facing(const OrientedCylinder& cylinder, const Vector3& n, double tolerance, const Vector3&) {
  if (std::abs(cylinder.axis.dot(n)) < tolerance) return side_line(cylinder, n);
  return {cylinder.centre + cylinder.farthest(n), cylinder.axis, 0.0};
}
Line line_facing(const OrientedBox& box, const Vector3& n, double tolerance, const Vector3& beside) {
  const Vector3 local = box.axes.transpose() * n, parallel = box.axes.transpose() * beside;
  int edge = -1;
  for (int i = 0; i < 3; ++i) {
    if (std::abs(local[i]) >= tolerance) continue;
    if (edge < 0 || std::abs(parallel[i]) > std::abs(parallel[edge])) edge = i;
  }
  const Vector3 corner = box.centre + box.farthest(n);
  if (edge < 0) return {corner, box.axes.col(0), 0.0};
  const Vector3 along = box.axes.col(edge);
  return {corner - along.dot(corner - box.centre) * along, along, box.half[edge]};
}

int name_facing(const OrientedCylinder&, const Line&) {
  return kEdgeOrCorner;
}
int name_facing(const OrientedBox& box, const Line& line) {
  const Vector3 local = box.axes.transpose() * (line.middle - box.centre);
  int corner = 0, edge = -1;
  for (int i = 0; i < 3; ++i) {
    corner |= int(local[i] >= 0.0) << i;
    if (line.half > 0.0 && box.axes.col(i).dot(line.along) > 0.9) edge = i;
  }
  return kEdgeOrCorner + (edge < 0 ? kBoxEdges + corner : edge_name(edge, corner));
}

template <typename ShapeA, typename ShapeB>
Manifold lines_or_point(const ShapeA& a, const ShapeB& b, const Vector3& normal, double separation) {
  for (const double tolerance : {kAlmostFaces, kFaces}) {
    const Line on_a = line_facing(a, -normal, tolerance, a.axis);
    const Line on_b = line_facing(b, normal, tolerance, a.axis);
    const bool both = on_a.half > 0.0 && on_b.half > 0.0;
    if (tolerance == kAlmostFaces && !both) continue;
    Manifold manifold = line_on_line(on_a, on_b, normal, kSides);
    if (manifold.count == 2) {
      const double missing = -separation - deepest_depth(manifold);
      manifold.points[0].depth += missing, manifold.points[1].depth += missing;
      return manifold;
    }
    if (tolerance == kAlmostFaces) continue;
    manifold.points[0].depth = -separation;
    manifold.points[0].feature = static_cast<std::uint8_t>(name_facing(b, on_b));
    return manifold;
  }
  return {};
}

using CylinderBoxAxis = ConvexAxis<OrientedCylinder, OrientedBox>;
using CylindersAxis = ConvexAxis<OrientedCylinder, OrientedCylinder>;

/// Where the cylinder is beside a corner of the box, or its rim over one.
void try_corners(const OrientedCylinder& a, const OrientedBox& b, CylinderBoxAxis& axis) {
  Vector3 least = Vector3::Zero();
  double nearest = 1e300;
  for (int bits = 0; bits < kBoxCorners; ++bits) {
    const Vector3 corner = b.corner(bits) - a.centre;
    const Vector3 level = a.across(corner);
    const double squared = level.squaredNorm();
    if (squared < nearest) nearest = squared, least = level;
    const double height = a.axis.dot(corner), above = std::abs(height) - a.half_length;
    if (above <= 0.0 || squared <= a.radius * a.radius) continue;
    const double beside = 1.0 - a.radius / std::sqrt(squared);
    axis.try_direction(beside * level + (height < 0.0 ? -above : above) * a.axis);
  }
  axis.try_direction(least);
}

void try_flats(const OrientedCylinder& a, const OrientedBox& b, CylinderBoxAxis& axis) {
  for (int i = 0; i < 3; ++i) axis.try_direction(b.axes.col(i));
  axis.try_direction(a.axis);
}
void try_flats(const OrientedCylinder& a, const OrientedCylinder& b, CylindersAxis& axis) {
  axis.try_direction(a.axis);
  axis.try_direction(b.axis);
}

void try_rest(const OrientedCylinder& a, const OrientedBox& b, double margin, CylinderBoxAxis& axis) {
  for (int i = 0; i < 3; ++i) axis.try_direction(b.axes.col(i).cross(a.axis));
  try_corners(a, b, axis);
  for (int i = 0; i < 3 && axis.separation() <= margin; ++i) axis.try_around(b.axes.col(i));
}
void try_rest(const OrientedCylinder& a, const OrientedCylinder& b, double margin, CylindersAxis& axis) {
  axis.try_direction(a.axis.cross(b.axis));
  axis.try_direction(a.across(axis.offset()));
  axis.try_direction(b.across(axis.offset()));
  if (axis.separation() > margin) return;
  axis.try_around(a.axis);
  axis.try_around(b.axis);
  const auto aslant = [&](const OrientedCylinder& c) -> Vector3 {
    const Vector3 out = c.across(axis.offset());
    return (c.axis.dot(axis.offset()) < 0.0 ? -1.0 : 1.0) * c.axis + out / std::max(out.norm(), kParallel);
  };
  for (const Vector3& start : {axis.offset(), aslant(a), aslant(b), Vector3(axis.normal() + 0.2 * aslant(a)),
                               Vector3(axis.normal() + 0.2 * aslant(b))}) {
    axis.climb(start);
  }
}

/// Faces first: what stands or lies on one needs no more.
template <typename ShapeB>
Manifold cylinder_manifold(const OrientedCylinder& a, const ShapeB& b, double margin) {
  ConvexAxis<OrientedCylinder, ShapeB> axis(a, b);
  try_flats(a, b, axis);
  if (axis.separation() > margin) return {};
  FlatContact flat = flat_contact(a, b, axis.normal(), axis.separation(), margin);
  if (flat.certain) return flat.manifold;
  const Vector3 face_normal = axis.normal();
  try_rest(a, b, margin, axis);
  if (axis.separation() > margin) return {};
  if (axis.normal() != face_normal) flat = flat_contact(a, b, axis.normal(), axis.separation(), margin);
  return flat.found ? flat.manifold : lines_or_point(a, b, axis.normal(), axis.separation());
}

}  // namespace

Manifold cylinder_box(const OrientedCylinder& a, const OrientedBox& b, double margin) {
  return cylinder_manifold(a, b, margin);
}

Manifold cylinder_cylinder(const OrientedCylinder& a, const OrientedCylinder& b, double margin) {
  return cylinder_manifold(a, b, margin);
}

}  // namespace mrhi
