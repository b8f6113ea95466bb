#pragma once

#include <algorithm>

#include "rendering/skin.h"

namespace mrhi::testing {

inline double distance_to_axis(const Capsule& capsule, const Vector3& p) {
  const Vector3 along = capsule.end - capsule.start;
  const double length = along.squaredNorm();
  const double s = length > 0.0 ? std::clamp((p - capsule.start).dot(along) / length, 0.0, 1.0) : 0.0;
  return (p - capsule.axis_point(s)).norm();
}

/// Farthest that the skin is off the nearest bone, the forearm's end left out, in widths of the palm.
inline double farthest_from_bones(const Hand& hand, const SkinSurface& surface) {
  constexpr double kForearm = 0.0;  // x of the rest hand's wrist
  double farthest = 0.0;
  for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
    if (Skin::human().rest()[v].x() < kForearm) continue;
    double nearest = 1e9;
    for (const Capsule& capsule : hand.capsules) {
      if (capsule.radius > 0.0) nearest = std::min(nearest, distance_to_axis(capsule, surface.vertices[v]));
    }
    farthest = std::max(farthest, nearest);
  }
  return farthest / hand.palm_width;
}

inline bool finite(const SkinSurface& surface) {
  const auto is_finite = [](const Vector3& v) { return v.allFinite(); };
  return std::all_of(surface.vertices.begin(), surface.vertices.end(), is_finite) &&
         std::all_of(surface.normals.begin(), surface.normals.end(), is_finite);
}

/// Triangles that face away from the skin around them.
inline int flipped_triangles(Side side, const SkinSurface& surface) {
  int flipped = 0;
  for (const auto& triangle : Skin::human().triangles()) {
    const auto a = static_cast<std::size_t>(triangle[0]), b = static_cast<std::size_t>(triangle[1]),
               c = static_cast<std::size_t>(triangle[2]);
    const Vector3 &p = surface.vertices[a], &q = surface.vertices[b], &r = surface.vertices[c];
    const Vector3 area = (side == Side::left ? -1.0 : 1.0) * (q - p).cross(r - p);
    flipped += area.dot(surface.normals[a] + surface.normals[b] + surface.normals[c]) < 0.0;
  }
  return flipped;
}

/// How far the skin is from a point inside it, in a direction (unit) [m].
inline double reach(const SkinSurface& surface, const Vector3& from, const Vector3& direction) {
  double nearest = 1e9;
  for (const auto& triangle : Skin::human().triangles()) {
    const Vector3& corner = surface.vertices[static_cast<std::size_t>(triangle[0])];
    Matrix3 basis;
    basis << surface.vertices[static_cast<std::size_t>(triangle[1])] - corner,
        surface.vertices[static_cast<std::size_t>(triangle[2])] - corner, -direction;
    const Vector3 at = basis.inverse() * (from - corner);
    if (at.x() >= 0.0 && at.y() >= 0.0 && at.x() + at.y() <= 1.0 && at.z() > 0.0)
      nearest = std::min(nearest, at.z());
  }
  return nearest;
}

}  // namespace mrhi::testing
