#include "box_face.h"

#include <algorithm>

namespace mrhi {
namespace {

/// A corner of the polygon that is left, and which line leads on from it: edge 0..3 of the incident face, or
/// border 4..7 of the reference.
struct Corner {
  std::array<double, 2> place;
  std::uint8_t feature;
  int line;
};
struct Polygon {
  std::array<Corner, 12> corners;
  int count = 0;

  void add(const Corner& corner) { corners[static_cast<std::size_t>(count++)] = corner; }
  const Corner& operator[](int i) const { return corners[static_cast<std::size_t>(i)]; }
};

class Clipping {
 public:
  Clipping(const BoxFace& reference, const BoxFace& incident, bool reference_is_a)
      : reference_(reference), incident_(incident), reference_is_a_(reference_is_a) {
    const Vector3 offset = incident.centre - reference.centre;
    const double facing = incident.normal.dot(reference.normal);
    for (std::size_t i = 0; i < 2; ++i) {
      middle_[i] = reference.along[i].dot(offset);
      slope_[i] = -incident.normal.dot(reference.along[i]) / facing;
      for (std::size_t j = 0; j < 2; ++j)
        side_[j][i] = incident.half[j] * reference.along[i].dot(incident.along[j]);
    }
    height_ = reference.normal.dot(offset);
    const double size = std::min(std::min(reference.half[0], reference.half[1]),
                                 std::min(incident.half[0], incident.half[1]));
    tolerance_ = border_tolerance(size, std::hypot(slope_[0], slope_[1]));
  }

  ContactRegion region() {
    for (std::size_t i = 0; i < 4; ++i) {
      const double x = BoxFace::kCorner[i][0], y = BoxFace::kCorner[i][1];
      polygon_.add(
          {{{middle_[0] + x * side_[0][0] + y * side_[1][0], middle_[1] + x * side_[0][1] + y * side_[1][1]}},
           corner_feature(incident_.corners[i], !reference_is_a_),
           static_cast<int>(i)});
    }
    for (int border = 0; border < 4 && polygon_.count > 0; ++border) clip(border);
    ContactRegion region;
    for (int i = 0; i < polygon_.count; ++i) region.add(point(polygon_[i]));
    return region;
  }

 private:
  static std::uint8_t corner_feature(int corner, bool of_a) {
    return static_cast<std::uint8_t>(of_a ? corner : kBoxCorners + corner);
  }
  /// Where a line of the polygon crosses a border.
  std::uint8_t crossing_feature(int line, int border) const {
    if (line >= 4) {
      const int next = line - 4 == (border + 1) % 4 ? line - 4 : border;
      return corner_feature(reference_.corners[static_cast<std::size_t>(next)], reference_is_a_);
    }
    const int edge = incident_.edges[static_cast<std::size_t>(line)];
    const int other = reference_.edges[static_cast<std::size_t>(border)];
    return reference_is_a_ ? crossing_name(other, edge) : crossing_name(edge, other);
  }

  /// What is out by less than the tolerance stays, and counts as on the border.
  void clip(int border) {
    const Border side = kBorders[static_cast<std::size_t>(border)];
    const auto d = static_cast<std::size_t>(side.dimension);
    const auto beyond = [&](const Corner& c) { return side.sign * c.place[d] - reference_.half[d]; };
    Polygon kept;
    for (int i = 0; i < polygon_.count; ++i) {
      const Corner& from = polygon_[i];
      const Corner& to = polygon_[(i + 1) % polygon_.count];
      const double from_beyond = beyond(from), to_beyond = beyond(to);
      const bool leaves = from_beyond <= tolerance_ && to_beyond > tolerance_;
      const bool enters = from_beyond > tolerance_ && to_beyond <= tolerance_;
      if (from_beyond <= tolerance_) kept.add(from);
      if (leaves && from_beyond >= 0.0)
        kept.corners[static_cast<std::size_t>(kept.count - 1)].line = 4 + border;
      if ((leaves && from_beyond < 0.0) || (enters && to_beyond < 0.0)) {
        const double part = from_beyond / (from_beyond - to_beyond);
        Corner crossing{{{from.place[0] + part * (to.place[0] - from.place[0]),
                          from.place[1] + part * (to.place[1] - from.place[1])}},
                        crossing_feature(from.line, border),
                        leaves ? 4 + border : from.line};
        crossing.place[d] = side.sign * reference_.half[d];
        kept.add(crossing);
      }
    }
    polygon_ = kept;
  }

  RegionPoint point(const Corner& corner) const {
    std::array<double, 2> place = corner.place;
    double height = height_;
    for (std::size_t i = 0; i < 2; ++i) {
      place[i] = std::max(-reference_.half[i], std::min(place[i], reference_.half[i]));
      height += slope_[i] * (place[i] - middle_[i]);
    }
    return {place[0], place[1], -height, corner.feature};
  }

  const BoxFace& reference_;
  const BoxFace& incident_;
  bool reference_is_a_;
  std::array<double, 2> middle_, slope_;
  std::array<std::array<double, 2>, 2> side_;
  double height_, tolerance_;
  Polygon polygon_;
};

}  // namespace

ContactRegion clip_face(const BoxFace& reference, const BoxFace& incident, bool reference_is_a) {
  return Clipping(reference, incident, reference_is_a).region();
}

}  // namespace mrhi
