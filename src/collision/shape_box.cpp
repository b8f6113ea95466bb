#include <limits>

#include "flat_part.h"

namespace mrhi {
namespace {

/// Half the derivative of the squared distance from the box by s. With e_i = excess of coordinate i: d^2 =
/// sum e_i^2, and half its derivative is sum along_i e_i, as e_i grows at the rate along_i outside the slab
/// and stays 0 inside.
double slope(const Segment& axis, const Vector3& half, double s) {
  double sum = 0.0;
  for (int i = 0; i < 3; ++i) sum += axis.along[i] * excess(axis.start[i] + s * axis.along[i], half[i]);
  return sum;
}

/// Where the axis is nearest to the box. The slope grows with s, linearly between the planes of the faces. It
/// bends where the axis passes a plane x_i = +-half_i, at s = (+-half_i - start_i) / along_i: with these six
/// places known the zero of one line is exact. An axis level with a face has a slope of exactly 0 over it,
/// and its middle is taken.
double nearest(const Segment& axis, const Vector3& half) {
  ConvexMinimum minimum(slope(axis, half, 0.0), slope(axis, half, 1.0));
  if (minimum.done()) return minimum.linear();
  for (int i = 0; i < 3; ++i) {
    if (axis.along[i] == 0.0) continue;
    const double inverse = 1.0 / axis.along[i];
    for (const double face : {-half[i], half[i]}) {
      const double s = (face - axis.start[i]) * inverse;
      if (minimum.holds(s)) minimum.add(s, slope(axis, half, s));
    }
  }
  return minimum.linear();
}

/// The dimension in which the whole axis is outside the box while it is between the faces of the others, or
/// none. That face is then nearest for every s, and the distance is linear in s. An axis within kOnSurface
/// takes the general search, which distinguishes a touch from an overlap.
int outside_dimension(const Capsule& capsule, const Vector3& half) {
  int outside = -1;
  for (int i = 0; i < 3; ++i) {
    const double lo = std::min(capsule.start[i], capsule.end[i]);
    const double hi = std::max(capsule.start[i], capsule.end[i]);
    if (lo >= -half[i] && hi <= half[i]) continue;
    if (outside >= 0 || (lo <= half[i] + kOnSurface && hi >= -half[i] - kOnSurface)) return -1;
    outside = i;
  }
  return outside;
}

/// The frequent case: the whole axis is over one face.
template <int i>
/// Nearest is its lower end, or the middle of what is level.
ClosestFeatures over_face(const Capsule& capsule, const Vector3& half) {
  const double side = capsule.start[i] > 0.0 ? 1.0 : -1.0;
  const double rise = side * (capsule.end[i] - capsule.start[i]);
  const double s = std::abs(rise) < kParallel ? 0.5 : rise > 0.0 ? 0.0 : 1.0;
  Vector3 point = capsule.axis_point(s);
  const double distance = side * point[i] - half[i] - capsule.radius;
  point[i] = side * half[i];
  return {distance, Vector3(i == 0 ? side : 0.0, i == 1 ? side : 0.0, i == 2 ? side : 0.0), point, s};
}

/// A direction in which the axis can leave the box: `separation` < 0 is how far it has to go.
struct BoxExit {
  double separation = -1e300;
  Vector3 normal;
  int dimension = 0;
  bool by_face = true;
};

/// The box swept along the axis is a polytope: its faces are those of the box, and those that an edge of the
/// box sweeps out. The axis leaves the box by the nearest. With m the axis's middle and l = along, they are
/// apart by
///     face normals +-e_i:        |m_i| - |l_i| / 2 - half_i
///     edge normals n = e_i x l:  |n.m| - sum |n_j| half_j, |n| = 1   (n.l = 0: the axis adds nothing)
/// It is the separating-axis test of a box and a segment (Ericson, Real-Time Collision Detection, 5.3.3), of
/// which the greatest value is kept instead of a yes or no. Of an axis along e_i the cross product is zero,
/// and a face is as good.
BoxExit leaving(const Segment& axis, const Vector3& half) {
  const Vector3 middle = axis.middle(), reach = 0.5 * axis.along.cwiseAbs();
  BoxExit best;
  for (int i = 0; i < 3; ++i) {
    const double separation = std::abs(middle[i]) - reach[i] - half[i];
    if (separation > best.separation) {
      best = {separation, (middle[i] < 0.0 ? -1.0 : 1.0) * Vector3::Unit(i), i, true};
    }
  }
  for (int i = 0; i < 3; ++i) {
    Vector3 normal = Vector3::Unit(i).cross(axis.along);
    const double length = normal.norm();
    if (length == 0.0) continue;
    normal *= (normal.dot(middle) < 0.0 ? -1.0 : 1.0) / length;
    const double separation = normal.dot(middle) - normal.cwiseAbs().dot(half);
    // Strictly better: an edge beside a face must not win by rounding.
    if (separation > best.separation + 1e-15) best = {separation, normal, i, false};
  }
  return best;
}

/// The end that is deeper, along the normal n, comes out last: the start where n.along > 0. Where the axis is
/// level all of it comes out at once, and the middle of what is over the face stands for it.
ClosestFeatures leave_by_face(const Segment& axis, const Vector3& half, const BoxExit& exit) {
  const int i = exit.dimension;
  double s = exit.normal[i] * axis.along[i] > 0.0 ? 0.0 : 1.0;
  if (axis.along[i] == 0.0) {
    Interval over;
    for (const int j : {(i + 1) % 3, (i + 2) % 3}) over.clip_to_slab(axis.start[j], axis.along[j], half[j]);
    s = over.middle();
  }
  Vector3 point = axis.at(s).cwiseMax(-half).cwiseMin(half);
  point[i] = exit.normal[i] * half[i];
  return {exit.separation, exit.normal, point, s};
}

/// The edge runs along e_i at the corner that n points to. Across e_i n is across the axis too, so that the
/// axis, moved out by -separation n, passes the edge where it is nearest to it now: at the foot s =
/// across.(edge - start) / across^2, with `across` the axis seen along e_i. Along e_i both are at one height.
ClosestFeatures leave_by_edge(const Segment& axis, const Vector3& half, const BoxExit& exit) {
  const int i = exit.dimension;
  Vector3 edge;
  for (int j = 0; j < 3; ++j) edge[j] = exit.normal[j] < 0.0 ? -half[j] : half[j];
  Vector3 across = axis.along;
  across[i] = 0.0;
  const double s = foot(axis.start, across, edge);
  edge[i] = std::max(-half[i], std::min(axis.at(s)[i], half[i]));
  return {exit.separation, exit.normal, edge, s};
}

}  // namespace

ClosestFeatures capsule_box(const Capsule& capsule, const Box& box) {
  const Vector3& half = box.half_extents;
  const int outside = outside_dimension(capsule, half);
  if (outside == 0) return over_face<0>(capsule, half);
  if (outside == 1) return over_face<1>(capsule, half);
  if (outside == 2) return over_face<2>(capsule, half);
  const Segment axis(capsule);
  const double s = nearest(axis, half);
  const Vector3 axis_point = axis.at(s);
  const Vector3 point = axis_point.cwiseMax(-half).cwiseMin(half);
  const Vector3 gap = axis_point - point;
  const double distance = gap.norm();
  if (distance > kOnSurface) return {distance - capsule.radius, gap / distance, point, s};
  const BoxExit exit = leaving(axis, half);
  ClosestFeatures features = exit.by_face ? leave_by_face(axis, half, exit) : leave_by_edge(axis, half, exit);
  features.distance -= capsule.radius;
  return features;
}

/// Rejects capsules beyond `margin` of a face's plane before the closed form: each plane gives the lower
/// bound |m_i| - |l_i| / 2 - half_i of the distance.
ClosestFeatures Box::closest(const Capsule& capsule, double margin) const {
  const Vector3 half_length = 0.5 * (capsule.end - capsule.start).cwiseAbs();
  const Vector3 gap = capsule.centre().cwiseAbs() - half_length - half_extents;
  if (gap.maxCoeff() > margin + capsule.radius)
    return {std::numeric_limits<double>::infinity(), Vector3::UnitZ(), Vector3::Zero(), 0.0};
  return capsule_box(capsule, *this);
}

/// The normal has one component on a face, two across an edge, three at a corner. Over a face the axis is
/// clipped by the slabs of the two other dimensions.
AxisSpan Box::span(const Capsule& capsule, const ClosestFeatures& features) const {
  const Segment axis(capsule);
  if (axis.along.isZero(0.0)) return at_point(features);
  int across = 0;
  Interval stretch;
  for (int i = 0; i < 3; ++i) {
    if (std::abs(features.normal[i]) > kSameNormal) {
      ++across;
    } else {
      stretch.clip_to_slab(axis.start[i], axis.along[i], half_extents[i]);
    }
  }
  return across == 1 ? over(stretch, features) : at_edge(features);
}

std::optional<Capsule> Box::core() const {
  return std::nullopt;
}

Vector3 Box::farthest(const Vector3& n) const {
  return (n.array() < 0.0).select(-half_extents, half_extents);
}

std::optional<double> Box::exit_distance(const Vector3& point, const Vector3& direction) const {
  Chord chord;
  for (int i = 0; i < 3; ++i) chord.clip_to_slab(point[i], direction[i], half_extents[i]);
  return chord.out();
}

///     V = 8 a b c,   integral of x^2 = V a^2 / 3
SolidMoments Box::moments() const {
  const double volume = 8.0 * half_extents.prod();
  return {volume, Vector3::Zero(), (volume / 3.0 * half_extents.cwiseAbs2()).asDiagonal()};
}

}  // namespace mrhi
