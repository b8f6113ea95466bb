#include "flat_face.h"

#include <algorithm>

namespace mrhi {
namespace {

/// A cylinder meets a face with its cap above, with a line of its side below this cosine.
constexpr double kCapOrSide = 0.7071067811865476;

}  // namespace

FlatFace FlatFace::of(const Line& line) {
  return {line.middle,
          Vector3::Zero(),
          {{line.along, Vector3::Zero()}},
          {{line.half, 0.0}},
          Outline::line,
          {{0, 1, 0, 0}},
          {}};
}

double FlatFace::to_border(const Vector3& point) const {
  const Vector3 offset = point - centre;
  if (is(Outline::circle)) return half[0] - (offset - normal.dot(offset) * normal).norm();
  return std::min(half[0] - std::abs(along[0].dot(offset)), half[1] - std::abs(along[1].dot(offset)));
}

FlatFace face_towards(const OrientedBox& box, const Vector3& outward) {
  const Vector3 local = box.axes.transpose() * outward;
  int side;
  local.cwiseAbs().maxCoeff(&side);
  const int first = (side + 1) % 3, second = (side + 2) % 3;
  const bool positive = local[side] >= 0.0;
  FlatFace face;
  face.normal = (positive ? 1.0 : -1.0) * box.axes.col(side);
  face.centre = box.centre + box.half[side] * face.normal;
  face.along = {{box.axes.col(first), box.axes.col(second)}};
  face.half = {{box.half[first], box.half[second]}};
  face.outline = FlatFace::Outline::rectangle;
  for (std::size_t i = 0; i < 4; ++i) {
    face.corners[i] =
        (int(positive) << side) | (int(kCorner[i][0] > 0) << first) | (int(kCorner[i][1] > 0) << second);
    face.edges[i] = edge_name(i % 2 == 0 ? first : second, face.corners[i]);
  }
  return face;
}

FlatFace face_towards(const OrientedCylinder& cylinder, const Vector3& outward) {
  const bool positive = cylinder.axis.dot(outward) >= 0.0;
  const Vector3 normal = (positive ? 1.0 : -1.0) * cylinder.axis;
  const int first = positive ? 4 : 0;
  return {cylinder.centre + cylinder.half_length * normal,
          normal,
          {{cylinder.axes.col(0), cylinder.axes.col(1)}},
          {{cylinder.radius, cylinder.radius}},
          FlatFace::Outline::circle,
          {{first, first + 1, first + 2, first + 3}},
          {}};
}

FlatFace lying_towards(const OrientedBox& box, const Vector3& outward) {
  return face_towards(box, outward);
}
FlatFace lying_towards(const OrientedCylinder& cylinder, const Vector3& outward) {
  const bool on_side = std::abs(cylinder.axis.dot(outward)) < kCapOrSide;
  return on_side ? FlatFace::of(side_line(cylinder, outward)) : face_towards(cylinder, outward);
}

Line side_line(const OrientedCylinder& cylinder, const Vector3& facing) {
  const Vector3 out = cylinder.across(facing);
  const double length = out.norm();
  return {cylinder.centre + (length > 0.0 ? cylinder.radius / length : 0.0) * out, cylinder.axis,
          cylinder.half_length};
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
Line line_facing(const OrientedCylinder& cylinder, const Vector3& n, double tolerance, const Vector3&) {
  if (std::abs(cylinder.axis.dot(n)) < tolerance) return side_line(cylinder, n);
  return {cylinder.centre + cylinder.farthest(n), cylinder.axis, 0.0};
}

}  // namespace mrhi
