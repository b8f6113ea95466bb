#include "flat_contact.h"

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

Manifold ends_on_plane(const Line& line, bool line_is_a, const Stretch& stretch,
                       const std::array<int, 2>& features, const Vector3& point, const Vector3& outward,
                       double margin) {
  Manifold manifold;
  manifold.normal = line_is_a ? outward : Vector3(-outward);
  for (const int end : {0, 1}) {
    const Vector3 place = line.at(end == 0 ? stretch.s0 : stretch.s1);
    const double depth = outward.dot(point - place);
    if (depth < -margin) continue;
    add_point(manifold, place + 0.5 * depth * outward, depth, features[static_cast<std::size_t>(end)]);
  }
  return manifold;
}

/// How far along `a` the lines, seen along the normal, are nearest.
double crossing(const Line& a, const Line& b, const Vector3& apart) {
  const double cosine = a.along.dot(b.along), s = apart.dot(a.along), t = apart.dot(b.along);
  const double sine_squared = a.along.cross(b.along).squaredNorm();
  if (sine_squared < 1e-20) return clamp(s, -a.half, a.half);
  const double on_b = clamp((cosine * s - t) / sine_squared, -b.half, b.half);
  return clamp(s + cosine * on_b, -a.half, a.half);
}

}  // namespace

Line side_line(const OrientedCylinder& cylinder, const Vector3& facing) {
  const Vector3 out = cylinder.across(facing);
  const double length = out.norm();
  return {cylinder.centre + (length > 0.0 ? cylinder.radius / length : 0.0) * out, cylinder.axis,
          cylinder.half_length};
}

Manifold line_on_face(const Line& line, bool line_is_a, const BoxFace& face, double margin) {
  const double rise = line.along.dot(face.normal);
  const double slope = std::abs(rise) / std::sqrt(std::max(1e-12, 1.0 - rise * rise));
  const double tolerance = border_tolerance(std::min(face.half[0], face.half[1]), slope);
  Stretch stretch{-line.half, line.half};
  std::array<int, 2> features{{0, 1}};
  for (std::size_t i = 0; i < 4; ++i) {
    const Border border = kBorders[i];
    const auto d = static_cast<std::size_t>(border.dimension);
    const double start = border.sign * face.along[d].dot(line.middle - face.centre);
    const double along = border.sign * face.along[d].dot(line.along);
    const Stretch before = stretch;
    const double border_at = face.half[d] + tolerance;
    const bool first_out = along < 0.0 && start + along * stretch.s0 > border_at;
    const bool last_out = along > 0.0 && start + along * stretch.s1 > border_at;
    if (first_out || last_out) {
      stretch.clip(start, along, face.half[d]);
    } else if (start > border_at) {
      return {};
    }
    if (stretch.s0 > before.s0) features[0] = 2 + static_cast<int>(i);
    if (stretch.s1 < before.s1) features[1] = 6 + static_cast<int>(i);
  }
  if (stretch.s0 > stretch.s1) return {};
  return ends_on_plane(line, line_is_a, stretch, features, face.centre, face.normal, margin);
}

Manifold line_on_disc(const Line& line, bool line_is_a, const Disc& disc, double margin) {
  const Vector3 offset = line.middle - disc.centre;
  const Vector3 middle = offset - offset.dot(disc.normal) * disc.normal;
  const Vector3 along = line.along - line.along.dot(disc.normal) * disc.normal;
  const double a = along.squaredNorm(), b = middle.dot(along);
  const double root = b * b - a * (middle.squaredNorm() - disc.radius * disc.radius);
  if (root <= 0.0) return {};
  const Stretch chord{(-b - std::sqrt(root)) / a, (-b + std::sqrt(root)) / a};
  const Stretch stretch{std::max(-line.half, chord.s0), std::min(line.half, chord.s1)};
  if (stretch.s0 > stretch.s1) return {};
  const std::array<int, 2> features{{chord.s0 > -line.half ? 10 : 0, chord.s1 < line.half ? 11 : 1}};
  return ends_on_plane(line, line_is_a, stretch, features, disc.centre, disc.normal, margin);
}

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
