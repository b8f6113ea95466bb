#include "flat_face.h"

namespace mrhi {
namespace {

/// Cosine above which a round shape meets a face with its cap, and below which with a line of its side.
constexpr double kMinCapCosine = 0.7071067811865476;

/// Smallest angle at which crossing lines touch at a point [rad].
constexpr double kMinCrossingAngle = 0.1;
/// Largest difference of depths along a level line [m].
constexpr double kLevelLine = 1e-9;

double clamp(double x, double lo, double hi) {
  return std::max(lo, std::min(x, hi));
}

/// How far along `a` the lines, seen along the normal, are nearest. With p = apart, a and b unit and c = a.b,
/// |p + t b - s a|^2 is least where
///     s = a.p + c t   and   t (1 - c^2) = c a.p - b.p,
/// with 1 - c^2 = |a x b|^2 from the cross product, as it cancels for lines that are almost parallel. Below
/// 1e-10 rad every s is as good.
double crossing(const Line& a, const Line& b, const Vector3& apart) {
  const double cosine = a.along.dot(b.along), s = apart.dot(a.along), t = apart.dot(b.along);
  const double sine_squared = a.along.cross(b.along).squaredNorm();
  if (sine_squared < 1e-20) return clamp(s, -a.half, a.half);
  const double on_b = clamp((cosine * s - t) / sine_squared, -b.half, b.half);
  return clamp(s + cosine * on_b, -a.half, a.half);
}

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
  const bool on_side = prism.round && std::abs(prism.axis().dot(outward)) < kMinCapCosine;
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

/// Parallel lines of half lengths h_a and h_b face each other where |s - middle| <= c h_b and |s| <= h_a, s
/// along a. Depth n.(on b - on a) is > 0 where b's line is above a's along n, which points from b to a.
/// Turned across each other by psi the two points draw together in proportion to 1 - sin psi / 0.1, about the
/// deeper end where depth changes along the lines, else about the crossing.
Manifold line_on_line(const Line& a, const Line& b, const Vector3& normal, int feature) {
  Manifold manifold;
  manifold.normal = normal;
  const Vector3 gap = b.middle - a.middle;
  const Vector3 apart = gap - gap.dot(normal) * normal;
  const auto add = [&](double s, int name) {
    const Vector3 on_a = a.at(s);
    const Vector3 beside = on_a + gap.dot(normal) * normal;
    const Vector3 on_b = b.at(clamp((beside - b.middle).dot(b.along), -b.half, b.half));
    const double depth = normal.dot(on_b - on_a);
    add_point(manifold, 0.5 * (on_a + on_b), depth, name);
  };
  const double across = a.along.cross(b.along).norm();
  const double ends = std::abs(a.along.dot(b.along)) * b.half, middle = apart.dot(a.along);
  const double from = std::max(-a.half, middle - ends), to = std::min(a.half, middle + ends);
  if (a.half == 0.0 || b.half == 0.0 || across >= kMinCrossingAngle || from >= to) {
    add(crossing(a, b, apart), feature);
    return manifold;
  }
  const double part = 1.0 - across / kMinCrossingAngle;
  const double rises =
      normal.dot(b.along * (a.along.dot(b.along) < 0.0 ? -1.0 : 1.0) - a.along) * (to - from);
  double kept = across < 1e-9 ? 0.5 * (from + to) : clamp(crossing(a, b, apart), from, to);
  if (rises > kLevelLine) kept = to;
  if (rises < -kLevelLine) kept = from;
  add(kept + part * (from - kept), feature);
  add(kept + part * (to - kept), feature + 1);
  return manifold;
}

}  // namespace mrhi
