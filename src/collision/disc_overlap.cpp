#include "flat_contact.h"

#include <algorithm>

namespace mrhi {
namespace {

constexpr double kQuarter = 1.5707963267948966;
/// No direction that a scene is likely to have: half-way between two rim points lies off every such.
constexpr double kFirstRimPoint = 0.25;
/// Rim points are fixed to the cylinder while the rim is out of level by less than the first, and follow the
/// lowest from the second on [m].
constexpr double kLevel = 1e-6, kTilted = 20e-6;

}  // namespace

Disc::Disc(const OrientedCylinder& cylinder, const Vector3& outward) {
  const bool positive = cylinder.axis.dot(outward) >= 0.0;
  normal = (positive ? 1.0 : -1.0) * cylinder.axis;
  centre = cylinder.centre + cylinder.half_length * normal;
  along = {{cylinder.axes.col(0), cylinder.axes.col(1)}};
  radius = cylinder.radius;
  cap = int(positive);
}

std::array<double, 4> rim_angles(double radius, const std::array<double, 2>& slope) {
  double first = kFirstRimPoint;
  const double rise = 2.0 * radius * std::hypot(slope[0], slope[1]);
  if (rise > kLevel) {
    const double lowest = std::atan2(slope[1], slope[0]) - kFirstRimPoint;
    const double follow = std::min(1.0, (rise - kLevel) / (kTilted - kLevel));
    first += follow * (lowest - kQuarter * std::round(lowest / kQuarter));
  }
  return {{first, first + kQuarter, first + 2 * kQuarter, first + 3 * kQuarter}};
}

DiscOverlap::DiscOverlap(const Disc& disc, bool disc_is_a, const Vector3& normal, const Vector3& face_point,
                         const Vector3& face_normal)
    : disc_(disc), disc_is_a_(disc_is_a), normal_(normal) {
  // From x along the normal to the face: (x + t n - face_point).face_normal = 0; depth is t for a, -t for b.
  const double scale = (disc_is_a ? 1.0 : -1.0) / normal.dot(face_normal);
  depth_ = scale * (face_point - disc.centre).dot(face_normal);
  for (std::size_t i = 0; i < 2; ++i) slope_[i] = -scale * disc.along[i].dot(face_normal);
  tolerance_ = border_tolerance(disc.radius, std::hypot(slope_[0], slope_[1]));
}

RegionPoint DiscOverlap::at(const Place& place, int feature) const {
  const double depth = depth_ + slope_[0] * place[0] + slope_[1] * place[1];
  return {place[0], place[1], depth, static_cast<std::uint8_t>(feature)};
}

DiscOverlap::Place DiscOverlap::project(const Vector3& point) const {
  const Vector3 offset = point - disc_.centre;
  const Vector3 in_plane = offset - offset.dot(disc_.normal) / normal_.dot(disc_.normal) * normal_;
  return {{disc_.along[0].dot(in_plane), disc_.along[1].dot(in_plane)}};
}

std::array<DiscOverlap::Place, 4> DiscOverlap::rim_points() const {
  std::array<Place, 4> points;
  const std::array<double, 4> angles = rim_angles(disc_.radius, slope_);
  for (std::size_t i = 0; i < 4; ++i) {
    points[i] = {{disc_.radius * std::cos(angles[i]), disc_.radius * std::sin(angles[i])}};
  }
  return points;
}

/// The part of the face's edge from..to that the disc covers, between the zeros of |from + s along|^2 =
/// radius^2: its start, or a corner where that is covered.
void DiscOverlap::add_chord(const Place& from, const Place& to, int corner, int edge,
                            ContactRegion& region) const {
  const Place along{{to[0] - from[0], to[1] - from[1]}};
  const double a = along[0] * along[0] + along[1] * along[1];
  const double b = from[0] * along[0] + from[1] * along[1];
  const double c = from[0] * from[0] + from[1] * from[1] - disc_.radius * disc_.radius;
  const double root = b * b - a * c;
  if (root <= 0.0) return;
  const double s0 = (-b - std::sqrt(root)) / a, s1 = (-b + std::sqrt(root)) / a;
  const double near_end = tolerance_ / std::sqrt(a);
  if (s1 <= near_end && s1 < 0.0) return;
  if (s0 >= 1.0 - near_end) return;
  const auto place = [&](double s) { return Place{{from[0] + s * along[0], from[1] + s * along[1]}}; };
  if (s0 <= near_end) {
    region.add(at(from, 8 + corner));
  } else {
    region.add(at(place(s0), 16 + 2 * edge));
  }
  if (s1 < 1.0 - near_end) region.add(at(place(std::max(s1, 0.0)), 16 + 2 * edge + 1));
}

ContactRegion DiscOverlap::with_face(const BoxFace& face) const {
  std::array<Place, 4> corners;
  for (std::size_t i = 0; i < 4; ++i) corners[i] = project(face.corner(i));
  const auto cross = [](const Place& o, const Place& p, const Place& q) {
    return (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0]);
  };
  const double turn = cross(corners[0], corners[1], corners[2]) < 0.0 ? -1.0 : 1.0;
  const auto over_face = [&](const Place& place) {
    for (std::size_t i = 0; i < 4; ++i) {
      const Place &from = corners[i], &to = corners[(i + 1) % 4];
      const double length = std::hypot(to[0] - from[0], to[1] - from[1]);
      if (turn * cross(from, to, place) < -tolerance_ * length) return false;
    }
    return true;
  };
  ContactRegion region;
  const std::array<Place, 4> rim = rim_points();
  for (std::size_t i = 0; i < 4; ++i) {
    if (over_face(rim[i])) region.add(at(rim[i], 4 * disc_.cap + static_cast<int>(i)));
  }
  if (region.count == 4) return region;
  for (std::size_t i = 0; i < 4; ++i) {
    add_chord(corners[i], corners[(i + 1) % 4], face.corners[i], face.edges[i], region);
  }
  region.sort_around();
  return region;
}

/// Of the place of the other disc that faces a place of this one.
double DiscOverlap::from_centre(const Disc& other, const Place& place) const {
  const Vector3 offset = disc_.centre + place[0] * disc_.along[0] + place[1] * disc_.along[1] - other.centre;
  return (offset - offset.dot(other.normal) / normal_.dot(other.normal) * normal_).norm();
}

/// Where the rims cross: exactly, by the law of cosines, if the discs are parallel, then by the secant
/// method.
void DiscOverlap::add_crossings(const Disc& other, ContactRegion& region) const {
  const Place centre = project(other.centre);
  const double away = std::hypot(centre[0], centre[1]), radius = disc_.radius;
  if (away <= 0.0) return;
  const double cosine = (away * away + radius * radius - other.radius * other.radius) / (2.0 * away * radius);
  if (std::abs(cosine) >= 1.0) return;
  const double towards = std::atan2(centre[1], centre[0]);
  for (const int side : {0, 1}) {
    const auto place = [&](double turn) {
      const double angle = towards + (side == 0 ? -turn : turn);
      return Place{{radius * std::cos(angle), radius * std::sin(angle)}};
    };
    const auto beyond = [&](double turn) { return from_centre(other, place(turn)) - other.radius; };
    double turn = std::acos(cosine), before = turn - 1e-4, beyond_before = beyond(before);
    for (int i = 0; i < 6; ++i) {
      const double value = beyond(turn), change = value - beyond_before;
      if (std::abs(value) < 1e-12 || std::abs(change) < 1e-15) break;
      const double next = turn - value * (turn - before) / change;
      before = turn, beyond_before = value, turn = next;
    }
    if (std::abs(beyond(turn)) < tolerance_) region.add(at(place(turn), 16 + side));
  }
}

ContactRegion DiscOverlap::with_disc(const Disc& other) const {
  ContactRegion region;
  const std::array<Place, 4> rim = rim_points();
  for (std::size_t i = 0; i < 4; ++i) {
    if (from_centre(other, rim[i]) <= other.radius + tolerance_) {
      region.add(at(rim[i], 4 * disc_.cap + static_cast<int>(i)));
    }
  }
  if (region.count == 4) return region;
  std::array<double, 2> slope;
  for (std::size_t i = 0; i < 2; ++i) {
    slope[i] =
        slope_[0] * disc_.along[0].dot(other.along[i]) + slope_[1] * disc_.along[1].dot(other.along[i]);
  }
  int feature = 8 + 4 * other.cap;
  for (const double angle : rim_angles(other.radius, slope)) {
    const Place place = project(other.at(angle));
    if (std::hypot(place[0], place[1]) <= disc_.radius + tolerance_) region.add(at(place, feature));
    ++feature;
  }
  add_crossings(other, region);
  region.sort_around();
  return region;
}

void DiscOverlap::add_to(Manifold& manifold, const ContactRegion& region) const {
  for (int i = 0; i < region.count; ++i) {
    const RegionPoint& p = region[i];
    const double half_way = (disc_is_a_ ? 0.5 : -0.5) * p.depth;
    add_point(manifold, disc_.centre + p.u * disc_.along[0] + p.v * disc_.along[1] + half_way * normal_,
              p.depth, p.feature);
  }
}

}  // namespace mrhi
