#include "mesh_manifold.h"

#include <algorithm>

#include "box_face.h"
#include "contact_region.h"
#include "disc_overlap.h"
#include "line_contact.h"
#include "sphere_manifold.h"

namespace mrhi {
namespace {

constexpr int kMostTouches = 128;
/// Touches whose normals are within 20 degrees of the deepest's belong to it.
constexpr double kAgrees = 0.94;
constexpr double kSameDepth = 1e-6;
constexpr int kCornerNames = 100, kEdgeNames = 28, kSecond = 128;
/// An edge that touches with its end leaves that to the corner there.
constexpr double kAtEnd = 1e-6;

struct Touch {
  Vector3 point, normal;
  double depth;
  std::uint8_t feature;
};

struct Touches {
  std::array<Touch, kMostTouches> found;
  int count = 0;

  const Touch& operator[](int i) const { return found[static_cast<std::size_t>(i)]; }
};

/// Measures what sticks out of one shape in the other.
struct Probes {
  const Pose& pose;
  const ManifoldShape& other;
  const Pose& other_pose;
  bool other_is_b;
  double margin;
  Touches& touches;

  void corner(const Vector3& point, int number) const { add(point, point, number % kCornerNames); }
  void edge(const Vector3& start, const Vector3& end, int number) const {
    add(start, end, kCornerNames + number % kEdgeNames);
  }
  void add(const Vector3& start, const Vector3& end, int name) const {
    if (touches.count == kMostTouches) return;
    const double reach = other.bounding_radius + margin + 0.5 * (end - start).norm();
    if ((0.5 * (start + end) - other_pose.position).squaredNorm() > reach * reach) return;
    const auto features =
        closest_on(other, {other_pose.to_local(start), other_pose.to_local(end), 0.0}, margin);
    if (!features) return;
    const bool at_end = features->axis_parameter < kAtEnd || features->axis_parameter > 1.0 - kAtEnd;
    if (start != end && at_end) return;
    const Vector3 normal = other_pose.orientation * features->normal;
    const Vector3 midway = features->point + 0.5 * features->distance * features->normal;
    touches.found[static_cast<std::size_t>(touches.count++)] = {
        other_pose * midway, other_is_b ? normal : Vector3(-normal), -features->distance,
        static_cast<std::uint8_t>(other_is_b ? name : kSecond + name)};
  }
};

struct Corners {
  const Probes& probes;

  void operator()(const Sphere&) const {}
  void operator()(const Box& shape) const {
    const OrientedBox box(shape, probes.pose);
    for (int i = 0; i < kBoxCorners; ++i) probes.corner(box.corner(i), i);
  }
  void operator()(const Cylinder& shape) const {
    const OrientedCylinder cylinder(shape, probes.pose);
    for (const double side : {-1.0, 1.0}) {
      const Disc cap(cylinder, side * cylinder.axis);
      int number = 4 * cap.cap;
      for (const double angle : rim_angles(cap.radius, {{0.0, 0.0}})) probes.corner(cap.at(angle), number++);
    }
  }
  void operator()(const Mesh& mesh) const {
    int number = 0;
    for (const Vector3& vertex : mesh.triangles->vertices) probes.corner(probes.pose * vertex, number++);
  }
};

struct Edges {
  const Probes& probes;

  void operator()(const Sphere&) const {}
  void operator()(const Box& shape) const {
    const OrientedBox box(shape, probes.pose);
    for (int i = 0; i < kBoxEdges; ++i) {
      const int direction = i / 4, first = (direction + 1) % 3, second = (direction + 2) % 3;
      const int low = (i & 1) << first | (i >> 1 & 1) << second;
      probes.edge(box.corner(low), box.corner(low | 1 << direction), i);
    }
  }
  /// The side line that faces the mesh, and with it the lowest point of a rim.
  void operator()(const Cylinder& shape) const;
  void operator()(const Mesh& mesh) const {
    const std::vector<Vector3>& vertices = mesh.triangles->vertices;
    int number = 0;
    for (const std::array<int, 3>& triangle : mesh.triangles->triangles) {
      for (std::size_t i = 0; i < 3; ++i, ++number) {
        const int from = triangle[i], to = triangle[(i + 1) % 3];
        if (from > to) continue;
        probes.edge(probes.pose * vertices[static_cast<std::size_t>(from)],
                    probes.pose * vertices[static_cast<std::size_t>(to)], number);
      }
    }
  }
};

void Edges::operator()(const Cylinder& shape) const {
  const OrientedCylinder cylinder(shape, probes.pose);
  const Pose& mesh_pose = probes.other_pose;
  const double inner = std::max(0.0, shape.half_length - shape.radius);
  const double radius = std::min(shape.radius, shape.half_length);
  const Capsule inside{mesh_pose.to_local(cylinder.centre - inner * cylinder.axis),
                       mesh_pose.to_local(cylinder.centre + inner * cylinder.axis), radius};
  const auto features = closest_on(probes.other, inside, probes.margin + shape.radius + shape.half_length);
  if (!features) return;
  const Vector3 facing = -(mesh_pose.orientation * features->normal);
  if (cylinder.across(facing).norm() < 0.01) return;
  const Line line = side_line(cylinder, facing);
  probes.corner(line.at(-line.half), 8);
  probes.corner(line.at(line.half), 9);
  probes.edge(line.at(-line.half), line.at(line.half), 0);
}

/// The points farthest out in eight directions: not more than these reach the final choice.
ContactRegion spread(const Touches& touches, const Touch& deepest, const Vector3& u, const Vector3& v) {
  ContactRegion region;
  std::array<bool, kMostTouches> taken{};
  const auto take = [&](int i) {
    const Touch& touch = touches[i];
    if (taken[static_cast<std::size_t>(i)]) return;
    taken[static_cast<std::size_t>(i)] = true;
    const Vector3 offset = touch.point - deepest.point;
    region.add({u.dot(offset), v.dot(offset), touch.depth, static_cast<std::uint8_t>(i)});
  };
  take(static_cast<int>(&deepest - touches.found.data()));
  for (int k = 0; k < 8; ++k) {
    const Vector3 out =
        std::cos(0.1 + 0.25 * 3.141592653589793 * k) * u + std::sin(0.1 + 0.25 * 3.141592653589793 * k) * v;
    int best = -1;
    double farthest = -1e300;
    for (int i = 0; i < touches.count; ++i) {
      if (touches[i].normal.dot(deepest.normal) < kAgrees) continue;
      const double far = out.dot(touches[i].point - deepest.point);
      if (far > farthest + kSameDepth) best = i, farthest = far;
    }
    if (best >= 0) take(best);
  }
  return region;
}

Manifold chosen(const Touches& touches) {
  Manifold manifold;
  if (touches.count == 0) return manifold;
  int deepest = 0;
  for (int i = 1; i < touches.count; ++i) {
    if (touches[i].depth > touches[deepest].depth + kSameDepth) deepest = i;
  }
  manifold.normal = touches[deepest].normal;
  const Vector3 u = manifold.normal.unitOrthogonal(), v = manifold.normal.cross(u);
  ContactRegion region = spread(touches, touches[deepest], u, v);
  region.sort_around();
  region.reduce();
  region.straighten();
  std::array<bool, 256> named{};
  for (int i = 0; i < region.count; ++i) {
    const Touch& touch = touches[region[i].feature];
    std::uint8_t name = touch.feature;
    while (named[name]) ++name;
    named[name] = true;
    add_point(manifold, touch.point, touch.depth, name);
  }
  return manifold;
}

}  // namespace

Manifold mesh_manifold(const ManifoldShape& a, const Pose& pose_a, const ManifoldShape& b, const Pose& pose_b,
                       double margin) {
  Touches touches;
  const Probes of_a{pose_a, b, pose_b, true, margin, touches},
      of_b{pose_b, a, pose_a, false, margin, touches};
  std::visit(Corners{of_a}, a.shape);
  std::visit(Corners{of_b}, b.shape);
  std::visit(Edges{of_a}, a.shape);
  std::visit(Edges{of_b}, b.shape);
  return chosen(touches);
}

}  // namespace mrhi
