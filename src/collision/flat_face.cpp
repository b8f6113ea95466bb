#include "flat_face.h"

#include <algorithm>

namespace mrhi {
namespace {

/// What is round meets a face with its cap above, with a line of its side below this cosine.
constexpr double kCapOrSide = 0.7071067811865476;

}  // namespace

/// Flat along itself only: `along` has the one direction, no breadth, and its two corners are the line's
/// ends, at +half and -half.
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

/// Largest component of `outward` in the prism's axes; a disc has its caps alone.
FlatFace face_towards(const Prism& prism, const Vector3& outward) {
  const Vector3 local = prism.axes.transpose() * outward;
  int side = 2;
  if (!prism.round) local.cwiseAbs().maxCoeff(&side);
  const int first = (side + 1) % 3, second = (side + 2) % 3;
  const bool positive = local[side] >= 0.0;
  FlatFace face;
  face.normal = (positive ? 1.0 : -1.0) * prism.axes.col(side);
  face.centre = prism.centre + prism.half[side] * face.normal;
  face.along = {{prism.axes.col(first), prism.axes.col(second)}};
  face.half = {{prism.half[first], prism.half[second]}};
  face.outline = prism.round ? FlatFace::Outline::circle : FlatFace::Outline::rectangle;
  for (std::size_t i = 0; i < 4; ++i) {
    face.corners[i] = prism.round ? 4 * int(positive) + int(i)
                                  : (int(positive) << side) | (int(kCorner[i][0] > 0) << first) |
                                        (int(kCorner[i][1] > 0) << second);
    face.edges[i] = prism.round ? 0 : edge_name(i % 2 == 0 ? first : second, face.corners[i]);
  }
  return face;
}

FlatFace lying_towards(const Prism& prism, const Vector3& outward) {
  const bool on_side = prism.round && std::abs(prism.axis().dot(outward)) < kCapOrSide;
  return on_side ? FlatFace::of(side_line(prism, outward)) : face_towards(prism, outward);
}

/// |n.axis i| < tolerance is the sine of the angle by which axis i is off square to n. The line's middle is
/// the support point with its part along the axis taken off: of a rectangle's edge the middle, of a round
/// side's line too.
Line line_facing(const Prism& prism, const Vector3& n, double tolerance, const Vector3& beside) {
  const Vector3 local = prism.axes.transpose() * n, parallel = prism.axes.transpose() * beside;
  int direction = -1, corner = 0;
  for (int i = prism.first_flat(); i < 3; ++i) {
    if (std::abs(local[i]) >= tolerance) continue;
    if (direction < 0 || std::abs(parallel[i]) > std::abs(parallel[direction])) direction = i;
  }
  for (int i = 0; i < 3; ++i) corner |= int(local[i] >= 0.0) << i;
  const Vector3 end = prism.centre + prism.farthest(n);
  if (direction < 0) return {end, prism.axis(), 0.0, prism.round ? 0 : kEdges + corner};
  const Vector3 along = prism.axes.col(direction);
  return {end - along.dot(end - prism.centre) * along, along, prism.half[direction],
          prism.round ? 0 : edge_name(direction, corner)};
}

}  // namespace mrhi
