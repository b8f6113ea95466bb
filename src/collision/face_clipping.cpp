#include "contact_region.h"

#include <algorithm>

// Two faces are seen along the reference's normal in the coordinates of one of them, the frame: the
// reference, or the incident face where that has the rim that touches. There the other is a polygon, a line
// or a circle, and how deep the one is below the other is a linear function of the place. What is common to
// both has for corners: those of each within the other, and where their borders cross. A rim counts with four
// of its points.

namespace mrhi {
namespace {

using Outline = FlatFace::Outline;

constexpr double kQuarter = 1.5707963267948966;
/// Angle of the first rim point: no direction that is likely in a scene lies on or half-way between rim
/// points.
constexpr double kFirstRimPoint = 0.25;
/// Rim points are fixed to the cylinder while its rim is level within the first, and follow the lowest point
/// beyond the second [m]: a standing can keeps the points that friction holds, one that rolls on its rim has
/// a point where it is lowest.
constexpr double kMaxLevel = 1e-6, kMinTilt = 20e-6;
/// A disc's rim is crossed by an edge, or another rim, where that comes in (0) and where it goes out (1).
constexpr int kIn = 0, kOut = 1;

/// Border i of a rectangle: the points with sign * coordinate[dimension] = half[dimension].
struct Border {
  std::size_t dimension;
  double sign;
};
constexpr std::array<Border, 4> kBorders{{{1, 1.0}, {0, -1.0}, {1, -1.0}, {0, 1.0}}};

double length(const Place& place) {
  return std::hypot(place[0], place[1]);
}
Place between(const Place& from, const Place& to, double part) {
  return {{from[0] + part * (to[0] - from[0]), from[1] + part * (to[1] - from[1])}};
}

/// With n the reference's normal, out of it, f the frame's and m the other's, all in world; places in the
/// frame are 2D coordinates about its centre.
class Clipping {
 public:
  // The plane of the other, m.(x - c) = 0, is above the frame's place p by t(p) = -m.(p - c) / (m.n) along n.
  // Depth is -t seen from the reference, where the incident face is below it, and +t seen from the incident
  // one: `inwards` is that sign. So
  //     slope_i = -inwards m.along_i / (m.n),   depth(p) = depth_ + slope.p.
  // A line has no plane: its depth is known along itself, rise / run, and is made constant across.
  Clipping(const FlatFace& frame, const FlatFace& other, bool frame_is_reference, bool frame_is_a)
      : frame_(frame),
        other_(other),
        normal_(frame_is_reference ? frame.normal : other.normal),
        frame_is_reference_(frame_is_reference),
        frame_is_a_(frame_is_a),
        per_height_(1.0 / normal_.dot(frame.normal)) {
    const Vector3 offset = other.centre - frame.centre;
    middle_ = project(offset);
    for (std::size_t j = 0; j < 2; ++j) side_[j] = project(other.half[j] * other.along[j]);
    const double inwards = frame_is_reference ? -1.0 : 1.0;
    if (other.is(Outline::line)) {  // it has a slope along itself only
      const double run = side_[0][0] * side_[0][0] + side_[0][1] * side_[0][1];
      const double rise = inwards * height(other.half[0] * other.along[0]);
      slope_ = {{rise / run * side_[0][0], rise / run * side_[0][1]}};
    } else {
      const double facing = inwards / normal_.dot(other.normal);
      for (std::size_t i = 0; i < 2; ++i) slope_[i] = -facing * other.normal.dot(frame.along[i]);
    }
    depth_ = inwards * height(offset) - slope_[0] * middle_[0] - slope_[1] * middle_[1];
    tolerance_ = border_tolerance(std::min(frame.size(), other.size()), length(slope_));
  }

  ContactRegion region() {
    if (other_.is(Outline::circle)) {
      rim_on_rim();
    } else {
      take_polygon();
      frame_.is(Outline::circle) ? polygon_on_rim() : polygon_on_rectangle();
    }
    return region_;
  }

  /// Midway between the faces.
  Vector3 place(const RegionPoint& p) const {
    return frame_.at(p.place) + (frame_is_reference_ ? -0.5 : 0.5) * p.depth * normal_;
  }

 private:
  /// Height of the end of an offset above the frame's plane, along the normal. x = in plane + height
  /// n with f.x = height (f.n): per_height_ is 1 / (f.n), 1 for the reference itself and about -1 for the
  /// incident face, which looks the other way.
  double height(const Vector3& offset) const { return per_height_ * offset.dot(frame_.normal); }
  /// Along n, not square to the frame: in a tilted frame the two differ.
  Place project(const Vector3& offset) const {
    if (frame_is_reference_) return {{frame_.along[0].dot(offset), frame_.along[1].dot(offset)}};
    const Vector3 in_plane = offset - height(offset) * normal_;
    return {{frame_.along[0].dot(in_plane), frame_.along[1].dot(in_plane)}};
  }
  /// Linear, as both are flat: d(p) = d_0 + slope.p, and so is known at every crossing without a third
  /// coordinate.
  double depth(const Place& place) const { return depth_ + slope_[0] * place[0] + slope_[1] * place[1]; }
  void add(const Place& place, std::uint8_t feature) { region_.add({place, depth(place), feature, 0}); }
  std::uint8_t crossing(int of_frame, int of_other) const {
    return frame_is_a_ ? crossing_name(of_frame, of_other) : crossing_name(of_other, of_frame);
  }

  /// Corners (+-1, +-1) of the rectangle's two half sides, seen in the frame: a parallelogram where it is
  /// tilted.
  void take_polygon() {
    const int corners = other_.is(Outline::line) ? 2 : 4;
    for (int i = 0; i < corners; ++i) {
      const double x = kCorner[i][0], y = kCorner[i][1];
      const Place place{
          {middle_[0] + x * side_[0][0] + y * side_[1][0], middle_[1] + x * side_[0][1] + y * side_[1][1]}};
      polygon_.add({place, 0.0, corner_name(other_.corners[i], !frame_is_a_), i});
    }
  }
  /// True for the second corner of a line, which starts no edge.
  bool is_end(int corner) const { return other_.is(Outline::line) && corner == polygon_.count - 1; }

  /// Corners kept for the tolerance are put onto the border, and their depth is that of the place there.
  void polygon_on_rectangle() {
    for (int border = 0; border < 4 && polygon_.count > 0; ++border) clip(border);
    region_ = polygon_;
    for (int i = 0; i < region_.count; ++i) {
      Place& place = region_[i].place;
      for (std::size_t d = 0; d < 2; ++d)
        place[d] = std::max(-frame_.half[d], std::min(place[d], frame_.half[d]));
      region_[i].depth = depth(place);
    }
  }
  /// Feature of a crossing of the polygon's line with a border. Corner i of the frame is between its borders
  /// i - 1 and i.
  std::uint8_t crossing_feature(int line, int border) const {
    if (line >= 4) {
      const int next = line - 4 == (border + 1) % 4 ? line - 4 : border;
      return corner_name(frame_.corners[next], frame_is_a_);
    }
    return crossing(frame_.edges[border], other_.edges[line]);
  }
  /// Clips by one border (Sutherland & Hodgman 1974). Corners outside by less than the tolerance stay, and
  /// count as on the border. With b = sign x_d - half_d of either end, the crossing is at the fraction b_from
  /// / (b_from - b_to): the signs differ, so that nothing cancels. Its coordinate on the border is set
  /// exactly for the next border. If no corner is outside, the polygon is unchanged, with its names.
  void clip(int border) {
    const Border side = kBorders[border];
    const std::size_t d = side.dimension;
    const auto beyond = [&](const RegionPoint& c) { return side.sign * c.place[d] - frame_.half[d]; };
    bool within = true;
    for (int i = 0; i < polygon_.count; ++i) within = within && beyond(polygon_[i]) <= tolerance_;
    if (within) return;
    ContactRegion kept;
    for (int i = 0; i < polygon_.count; ++i) {
      const RegionPoint& from = polygon_[i];
      const RegionPoint& to = polygon_[is_end(i) ? i : (i + 1) % polygon_.count];
      const double from_beyond = beyond(from), to_beyond = beyond(to);
      const bool leaves = from_beyond <= tolerance_ && to_beyond > tolerance_;
      const bool enters = from_beyond > tolerance_ && to_beyond <= tolerance_;
      if (from_beyond <= tolerance_) kept.add(from);
      if (leaves && from_beyond >= 0.0) kept[kept.count - 1].line = 4 + border;
      if ((leaves && from_beyond < 0.0) || (enters && to_beyond < 0.0)) {
        RegionPoint crossing{between(from.place, to.place, from_beyond / (from_beyond - to_beyond)), 0.0,
                             crossing_feature(from.line, border), leaves ? 4 + border : from.line};
        crossing.place[d] = side.sign * frame_.half[d];
        kept.add(crossing);
      }
    }
    polygon_ = kept;
  }

  Place rim_point(const FlatFace& disc, double angle) const {
    if (&disc != &frame_) return project(disc.on_circle(angle) - frame_.centre);
    return {{disc.half[0] * std::cos(angle), disc.half[0] * std::sin(angle)}};
  }
  /// Adds those of a disc's four rim points that are within the other face.
  template <typename Within>
  void add_rim(const FlatFace& disc, bool is_a, const Place& slope, const Within& within) {
    const std::array<double, 4> angles = rim_angles(disc.half[0], slope);
    for (std::size_t i = 0; i < 4; ++i) {
      const Place place = rim_point(disc, angles[i]);
      if (within(place)) add(place, corner_name(disc.corners[i], is_a));
    }
  }

  void polygon_on_rim() {
    const bool closed = !other_.is(Outline::line);
    if (closed)
      add_rim(frame_, frame_is_a_, slope_, [this](const Place& place) { return in_polygon(place); });
    if (closed && region_.count == 4) return;
    for (int i = 0; i < polygon_.count; ++i) {
      if (!is_end(i)) add_chord(polygon_[i], polygon_[(i + 1) % polygon_.count]);
    }
    if (closed) region_.sort_around();
  }
  /// True if the point is left of all four sides, or right of all: a rectangle seen from below has the other
  /// sense, which `turn` gives. The cross product with a side is its length times the distance from it.
  bool in_polygon(const Place& place) const {
    const double turn = cross(polygon_[0].place, polygon_[1].place, polygon_[2].place) < 0.0 ? -1.0 : 1.0;
    for (int i = 0; i < 4; ++i) {
      const Place &from = polygon_[i].place, &to = polygon_[(i + 1) % 4].place;
      const double size = std::hypot(to[0] - from[0], to[1] - from[1]);
      if (turn * cross(from, to, place) < -tolerance_ * size) return false;
    }
    return true;
  }
  /// The part of an edge that the disc covers, between the zeros of |from + s along|^2 = radius^2: its start,
  /// or a corner where that is covered.
  ///
  /// a s^2 + 2 b s + c = 0 with s in 0..1 along the edge. Each edge adds where the part begins, and where it
  /// ends only if that is not a corner, which the next edge adds: every corner once.
  void add_chord(const RegionPoint& from, const RegionPoint& to) {
    const Place start = from.place, along{{to.place[0] - start[0], to.place[1] - start[1]}};
    const int edge = other_.edges[from.line];
    const double a = along[0] * along[0] + along[1] * along[1];
    const double b = start[0] * along[0] + start[1] * along[1];
    const double c = start[0] * start[0] + start[1] * start[1] - frame_.half[0] * frame_.half[0];
    const double root = b * b - a * c;
    if (root <= 0.0) return;
    const double s0 = (-b - std::sqrt(root)) / a, s1 = (-b + std::sqrt(root)) / a;
    const double near_end = tolerance_ / std::sqrt(a);
    if (s1 < 0.0 || s0 >= 1.0 - near_end) return;
    const bool from_is_in = s0 <= near_end, to_is_in = s1 >= 1.0 - near_end;
    add(from_is_in ? start : between(start, to.place, s0), from_is_in ? from.feature : crossing(kIn, edge));
    if (!to_is_in) add(between(start, to.place, s1), crossing(kOut, edge));
    if (to_is_in && other_.is(Outline::line)) add(to.place, to.feature);
  }

  /// Distance of a point, projected on the other disc, beyond its rim. x less (x.m / n.m) n is the place on
  /// the other's plane above or below, along n.
  double beyond_rim(const Place& place) const {
    const Vector3 offset = frame_.at(place) - other_.centre;
    return (offset - offset.dot(other_.normal) / normal_.dot(other_.normal) * normal_).norm() -
           other_.half[0];
  }
  /// The slope is a vector in the frame's plane, seen again along the other's axes for its lowest point.
  void rim_on_rim() {
    add_rim(frame_, frame_is_a_, slope_,
            [this](const Place& place) { return beyond_rim(place) <= tolerance_; });
    if (region_.count == 4) return;
    Place slope;
    for (std::size_t i = 0; i < 2; ++i)
      slope[i] = (slope_[0] * frame_.along[0] + slope_[1] * frame_.along[1]).dot(other_.along[i]);
    add_rim(other_, !frame_is_a_, slope,
            [this](const Place& place) { return length(place) <= frame_.half[0] + tolerance_; });
    add_rim_crossings();
    region_.sort_around();
  }
  /// Exactly, by the law of cosines, if the discs are parallel, then by the secant method. With the other's
  /// centre at the distance D, and r and R the radii, the rims cross at +-turn from the direction to it, R^2
  /// = D^2 + r^2 - 2 D r cos turn. None if one is within the other, or beyond it: |cos| >= 1. A tilted rim is
  /// an ellipse along n, and the circle's answer is a first guess.
  void add_rim_crossings() {
    const double away = length(middle_), radius = frame_.half[0], beyond_size = other_.half[0];
    if (away <= 0.0) return;
    const double cosine = (away * away + radius * radius - beyond_size * beyond_size) / (2.0 * away * radius);
    if (std::abs(cosine) >= 1.0) return;
    const double towards = std::atan2(middle_[1], middle_[0]);
    for (const int side : {kIn, kOut}) {
      const auto place = [&](double turn) {
        return rim_point(frame_, towards + (side == kIn ? -turn : turn));
      };
      double turn = std::acos(cosine), before = turn - 1e-4, beyond_before = beyond_rim(place(before));
      for (int i = 0; i < 6; ++i) {
        const double value = beyond_rim(place(turn)), change = value - beyond_before;
        if (std::abs(value) < 1e-12 || std::abs(change) < 1e-15) break;
        const double next = turn - value * (turn - before) / change;
        before = turn, beyond_before = value, turn = next;
      }
      if (std::abs(beyond_rim(place(turn))) < tolerance_) add(place(turn), crossing(0, side));
    }
  }

  const FlatFace &frame_, &other_;
  const Vector3& normal_;  // of the reference
  const bool frame_is_reference_, frame_is_a_;
  const double per_height_;
  Place middle_, slope_;
  std::array<Place, 2> side_;  // of the other: to its middle, and half its sides
  double depth_, tolerance_;   // depth at the frame's centre
  ContactRegion polygon_, region_;
};

}  // namespace

/// The rim is out of level by 2 r |slope| from its highest to its lowest, the gradient's direction. Turned by
/// less than an eighth of a turn, one way or the other, to the nearest of the four: a quarter turn leaves the
/// four in place, but for their names. From kMaxLevel to kMinTilt the points glide there in proportion, so
/// that none jumps.
std::array<double, 4> rim_angles(double radius, const Place& slope) {
  double first = kFirstRimPoint;
  const double rise = 2.0 * radius * length(slope);
  if (rise > kMaxLevel) {
    const double lowest = std::atan2(slope[1], slope[0]) - kFirstRimPoint;
    const double follow = std::min(1.0, (rise - kMaxLevel) / (kMinTilt - kMaxLevel));
    first += follow * (lowest - kQuarter * std::round(lowest / kQuarter));
  }
  return {{first, first + kQuarter, first + 2 * kQuarter, first + 3 * kQuarter}};
}

/// Regions that gaps are taken from stay convex polygons in order, of which reduce() leaves four. The frame
/// is the one that has a rim, of two the incident one, which is no larger. The normal is turned to point out
/// of b: the reference's own points out of the reference.
Manifold touch(const FlatFace& reference, const FlatFace& incident, bool reference_is_a, double margin) {
  const bool by_reference = !incident.is(Outline::circle);
  Clipping clipping(by_reference ? reference : incident, by_reference ? incident : reference, by_reference,
                    by_reference == reference_is_a);
  ContactRegion region = clipping.region();
  region.remove_gaps(margin);
  region.reduce();
  Manifold manifold;
  manifold.normal = reference_is_a ? Vector3(-reference.normal) : reference.normal;
  for (int i = 0; i < region.count; ++i)
    add_point(manifold, clipping.place(region[i]), region[i].depth, region[i].feature);
  return manifold;
}

}  // namespace mrhi
