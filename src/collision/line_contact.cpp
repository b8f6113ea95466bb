#include "flat_face.h"

#include <algorithm>

namespace mrhi {
namespace {

/// Lines that cross at this angle touch at a point [rad].
constexpr double kCrosses = 0.1;
/// Depths that differ by less than this along a line are the same [m].
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
  if (a.half == 0.0 || b.half == 0.0 || across >= kCrosses || from >= to) {
    add(crossing(a, b, apart), feature);
    return manifold;
  }
  const double part = 1.0 - across / kCrosses;
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
