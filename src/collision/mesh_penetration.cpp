#include <optional>

#include "mesh_surface.h"

namespace mrhi {
namespace {

struct WayOut {
  double separation = -1e300;
  Vector3 normal = Vector3::UnitZ();
  Stretch stretch{0.5, 0.5};  // of the segment, that comes out last
  bool through = false;       // the face itself, not only its plane
};

double separation_from(const Segment& segment, const Triangle& face) {
  return face.normal.dot(segment.start - face.corners[0]) + std::min(face.normal.dot(segment.along), 0.0);
}

WayOut way_out(const Segment& segment, const Triangle& face) {
  WayOut way;
  way.separation = separation_from(segment, face);
  way.normal = face.normal;
  const double rise = face.normal.dot(segment.along);
  way.stretch = {rise > -kParallel ? 0.0 : 1.0, rise < kParallel ? 1.0 : 0.0};
  const Stretch over = face.over(segment);
  const Stretch through{std::max(over.s0, way.stretch.s0), std::min(over.s1, way.stretch.s1)};
  way.through = through.s0 <= through.s1;
  if (way.through) way.stretch = through;
  return way;
}

/// Triangles of one flat face are one way out.
void keep_better(const WayOut& way, WayOut& best) {
  const double gain = way.separation - best.separation;
  const bool same = std::abs(gain) < kOnSurface && way.normal.dot(best.normal) > 1.0 - 1e-12;
  if (same && way.through && best.through) {
    best.stretch.join(way.stretch);
  } else if (same ? way.through : gain > 0.0) {
    best = way;
  }
}

/// Across the segment and the edge, if that is a direction between those of the edge's faces. Seen along it,
/// the two cross where the segment comes out.
std::optional<ClosestFeatures> leave_by_edge(const Segment& segment, const MeshSurface::ConvexEdge& edge,
                                             bool convex) {
  const double rise = edge.normal.dot(segment.along), other_rise = edge.other_normal.dot(segment.along);
  if (rise * other_rise >= 0.0) return std::nullopt;
  const Vector3 normal =
      (std::abs(other_rise) * edge.normal + std::abs(rise) * edge.other_normal).normalized();
  const double separation = normal.dot(segment.middle() - edge.start);
  const Vector3 offset = edge.start + separation * normal - segment.start;
  const double a = segment.along.squaredNorm(), b = segment.along.dot(edge.along),
               c = edge.along.squaredNorm();
  const double d = segment.along.dot(offset), e = edge.along.dot(offset);
  const double determinant = a * c - b * b;
  if (determinant <= 0.0) return std::nullopt;
  const double s = (d * c - b * e) / determinant, t = (b * d - a * e) / determinant;
  const double s_held = std::max(0.0, std::min(s, 1.0)), t_held = std::max(0.0, std::min(t, 1.0));
  if (!convex && (s != s_held || t != t_held)) return std::nullopt;
  return ClosestFeatures{separation, normal, edge.start + t_held * edge.along, s_held};
}

}  // namespace

ClosestFeatures leave_mesh(const Segment& segment, const MeshSurface& surface, int fallback) {
  WayOut best;
  for (const Triangle& face : surface.triangles()) {
    if (separation_from(segment, face) < best.separation - kOnSurface) continue;
    const WayOut way = way_out(segment, face);
    const bool allowed = surface.convex() || (way.through && way.separation < kOnSurface);
    if (allowed) keep_better(way, best);
  }
  ClosestFeatures features{best.separation, best.normal, Vector3::Zero(), 0.5};
  bool by_edge = false;
  for (const MeshSurface::ConvexEdge& edge : surface.convex_edges()) {
    const auto way = leave_by_edge(segment, edge, surface.convex());
    const bool allowed = way && (surface.convex() || way->distance < kOnSurface);
    if (allowed && way->distance > features.distance + kParallel) features = *way, by_edge = true;
  }
  if (by_edge) return features;
  if (best.separation == -1e300) {
    best = way_out(segment, surface.triangles()[static_cast<std::size_t>(fallback)]);
  }
  const double s = best.stretch.middle();
  return {best.separation, best.normal, segment.at(s) - best.separation * best.normal, s};
}

}  // namespace mrhi
