#include "triangle.h"

namespace mrhi {
namespace {

double clamp_unit(double x) {
  return std::max(0.0, std::min(x, 1.0));
}

struct EdgeNearest {
  Stretch stretch;
  double t;  // along the edge, facing the stretch's middle
};

/// Nearest stretch of the segment to the edge from `corner` along `edge` (Ericson, Real-Time Collision
/// Detection, 5.1.9).
EdgeNearest nearest_on_edge(const Segment& segment, const Vector3& corner, const Vector3& edge) {
  const Vector3 offset = segment.start - corner, &along = segment.along;
  const double a = along.squaredNorm(), e = edge.squaredNorm(), b = along.dot(edge);
  const double c = along.dot(offset), f = edge.dot(offset);
  if (a == 0.0) return {{0.5, 0.5}, clamp_unit(f / e)};
  const bool parallel = along.cross(edge).squaredNorm() <= kParallel * kParallel * e;
  if (parallel) {
    const double at_start = -c / a, at_end = (b - c) / a;
    const double s0 = clamp_unit(std::min(at_start, at_end)), s1 = clamp_unit(std::max(at_start, at_end));
    return {{s0, s1}, clamp_unit((0.5 * (s0 + s1) * b + f) / e)};
  }
  double s = clamp_unit((b * f - c * e) / (a * e - b * b));
  const double t = clamp_unit((b * s + f) / e);
  s = clamp_unit((b * t - c) / a);
  return {{s, s}, clamp_unit((b * s + f) / e)};
}

}  // namespace

Stretch Triangle::over(const Segment& segment) const {
  Stretch stretch;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3 outward = (corners[(i + 1) % 3] - corners[i]).cross(normal);
    const double x0 = outward.dot(segment.start - corners[i]), dx = outward.dot(segment.along);
    stretch.clip(x0, dx, 0.0);
    if (dx == 0.0 && x0 > 0.0) return {1.0, 0.0};
  }
  return stretch;
}

/// Distance 1e300 if an edge may be nearer than the face.
TriangleNearest Triangle::nearest_by_face(const Segment& segment) const {
  TriangleNearest found;
  const Stretch above = over(segment);
  if (above.s0 > above.s1) return found;
  const double height = normal.dot(segment.start - corners[0]), rise = normal.dot(segment.along);
  const bool parallel = std::abs(rise) < kParallel;
  const double crossing = parallel ? above.middle() : -height / rise;
  const double s = std::max(above.s0, std::min(crossing, above.s1));
  const bool crosses = s == crossing, ends = s == 0.0 || s == 1.0;
  if (!crosses && !ends) return found;
  found.stretch = parallel ? above : Stretch{s, s};
  const double level = height + s * rise;
  found.distance = crosses && !parallel ? 0.0 : std::abs(level);
  found.point = segment.at(s) - level * normal;
  return found;
}

TriangleNearest Triangle::nearest_by_edge(const Segment& segment, int edge) const {
  const auto i = static_cast<std::size_t>(edge), next = (i + 1) % 3;
  const Vector3 along = corners[next] - corners[i];
  const EdgeNearest nearest = nearest_on_edge(segment, corners[i], along);
  TriangleNearest found;
  found.stretch = nearest.stretch;
  found.point = corners[i] + nearest.t * along;
  found.distance = (segment.at(nearest.stretch.middle()) - found.point).norm();
  found.part = nearest.t <= 0.0 || nearest.t >= 1.0 ? TrianglePart::vertex : TrianglePart::edge;
  found.index = static_cast<int>(nearest.t >= 1.0 ? next : i);
  return found;
}

TriangleNearest Triangle::nearest(const Segment& segment) const {
  TriangleNearest best = nearest_by_face(segment);
  if (best.distance < 1e300) return best;
  for (int edge = 0; edge < 3; ++edge) {
    const TriangleNearest found = nearest_by_edge(segment, edge);
    if (found.distance < best.distance - kParallel) best = found;
  }
  return best;
}

}  // namespace mrhi
