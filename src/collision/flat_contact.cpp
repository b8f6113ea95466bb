#include "flat_contact.h"

#include <algorithm>

namespace mrhi {
namespace {

/// A cap meets a face with its rim, above; a side with its line, below this cosine.
constexpr double kCapOrSide = 0.7071067811865476;

const ManifoldPoint* deepest_of(const Manifold& manifold) {
  const auto shallower = [](const ManifoldPoint& a, const ManifoldPoint& b) { return a.depth < b.depth; };
  return std::max_element(manifold.points.begin(), manifold.points.begin() + manifold.count, shallower);
}
Vector3 deepest_point(const Manifold& manifold) {
  return manifold.count > 0 ? deepest_of(manifold)->point : Vector3::Zero();
}

Manifold flat(const DiscOverlap& overlap, ContactRegion region, const Vector3& normal, double margin) {
  Manifold manifold;
  manifold.normal = normal;
  region.remove_gaps(margin);
  region.reduce();
  overlap.add_to(manifold, region);
  return manifold;
}

/// By the box's face, out of b.
Manifold on_face(const OrientedCylinder& a, const BoxFace& face, double margin) {
  if (std::abs(a.axis.dot(face.normal)) < kCapOrSide) {
    return line_on_face(side_line(a, -face.normal), true, face, margin);
  }
  const Disc disc(a, -face.normal);
  const DiscOverlap overlap(disc, true, face.normal, face.centre, face.normal);
  return flat(overlap, overlap.with_face(face), face.normal, margin);
}

/// By the cap of the cylinder a against a box.
Manifold on_cap(const Disc& cap, const OrientedBox& b, double margin) {
  const BoxFace face(b, -cap.normal);
  const DiscOverlap overlap(cap, true, -cap.normal, face.centre, face.normal);
  return flat(overlap, overlap.with_face(face), -cap.normal, margin);
}

/// By the cap of one cylinder against another.
Manifold on_cap_of(bool cap_is_a, const Disc& cap, const OrientedCylinder& other, double margin) {
  if (std::abs(other.axis.dot(cap.normal)) < kCapOrSide) {
    return line_on_disc(side_line(other, -cap.normal), !cap_is_a, cap, margin);
  }
  const Disc disc(other, -cap.normal);
  const Vector3 normal = cap_is_a ? Vector3(-cap.normal) : cap.normal;
  const bool parallel = -disc.normal.dot(cap.normal) >= kSameFace;
  const bool by_other = !parallel || disc.radius < cap.radius * (1.0 + kSameSize);
  const Disc &whole = by_other ? disc : cap, &part = by_other ? cap : disc;
  const DiscOverlap overlap(whole, by_other != cap_is_a, normal, part.centre, part.normal);
  return flat(overlap, overlap.with_disc(part), normal, margin);
}

Manifold on_cap(const Disc& cap, const OrientedCylinder& b, double margin) {
  return on_cap_of(true, cap, b, margin);
}
Manifold on_face(const OrientedCylinder& a, const Disc& cap, double margin) {
  return on_cap_of(false, cap, a, margin);
}

/// Is no other direction better than the face's? Turned by t towards where the deepest point is w from the
/// face's border, the overlap d grows to d cos t + w sin t at least.
bool is_certain(const Manifold& manifold, double to_border, double thickness) {
  constexpr double kSameDepth = 1e-6;
  const double depth = deepest_depth(manifold);
  if (depth <= 0.0 || to_border >= 2.0 * depth) return 4.0 * depth < thickness;
  // Or where it touches in a region that is w wide in every direction.
  double width = manifold.count > 2 ? 1e300 : 0.0;
  for (int i = 0; i < manifold.count; ++i) {
    const ManifoldPoint& from = manifold.points[static_cast<std::size_t>(i)];
    if (from.depth < depth - kSameDepth) return false;
    for (int j = 0; j < i; ++j) {
      const Vector3 edge = manifold.points[static_cast<std::size_t>(j)].point - from.point;
      const Vector3 out = edge.cross(manifold.normal);
      double low = 0.0, high = 0.0;
      for (int k = 0; k < manifold.count; ++k) {
        const double beside = out.dot(manifold.points[static_cast<std::size_t>(k)].point - from.point);
        low = std::min(low, beside), high = std::max(high, beside);
      }
      width = std::min(width, (high - low) / std::max(out.norm(), kParallel));
    }
  }
  return width >= 2.0 * depth && 4.0 * depth < thickness;
}

double to_border(const BoxFace& face, const Manifold& manifold) {
  const Vector3 offset = deepest_point(manifold) - face.centre;
  return std::min(face.half[0] - std::abs(face.along[0].dot(offset)),
                  face.half[1] - std::abs(face.along[1].dot(offset)));
}
double to_border(const Disc& disc, const Manifold& manifold) {
  const Vector3 offset = deepest_point(manifold) - disc.centre;
  return disc.radius - (offset - disc.normal.dot(offset) * disc.normal).norm();
}

template <typename FaceB>
bool reference_is_a(const Disc& cap, const FaceB& face, const Vector3& n) {
  const bool face_flat = face.normal.dot(n) >= kSameFace;
  return -cap.normal.dot(n) >= kSameFace && (!face_flat || first_is_reference(cap.area(), face.area(), n));
}

/// By the cap of a or the `face` of b.
template <typename ShapeB, typename FaceB>
FlatContact by_flat(const OrientedCylinder& a, const ShapeB& b, const FaceB& face, const Vector3& n,
                    double separation, double margin) {
  const Disc cap(a, -n);
  FlatContact flat;
  double border = 0.0;
  if (reference_is_a(cap, face, n)) {
    flat.manifold = on_cap(cap, b, margin);
    border = to_border(cap, flat.manifold);
  } else if (face.normal.dot(n) >= kSameFace) {
    flat.manifold = on_face(a, face, margin);
    border = to_border(face, flat.manifold);
  }
  flat.found = as_deep(deepest_depth(flat.manifold), separation);
  flat.certain = flat.found && is_certain(flat.manifold, border, 2.0 * std::min(a.reach(n), b.reach(n)));
  return flat;
}

}  // namespace

double deepest_depth(const Manifold& manifold) {
  return manifold.count > 0 ? deepest_of(manifold)->depth : -1e300;
}

FlatContact flat_contact(const OrientedCylinder& a, const OrientedBox& b, const Vector3& n, double separation,
                         double margin) {
  return by_flat(a, b, BoxFace(b, n), n, separation, margin);
}

FlatContact flat_contact(const OrientedCylinder& a, const OrientedCylinder& b, const Vector3& n,
                         double separation, double margin) {
  return by_flat(a, b, Disc(b, n), n, separation, margin);
}

}  // namespace mrhi
