#include "contact_region.h"

#include <algorithm>

namespace mrhi {
namespace {

/// Largest difference between equal depths [m].
constexpr double kSameDepth = 1e-6;
/// Relative and absolute differences up to which areas are equal.
constexpr double kSameArea = 1e-3, kNoArea = 1e-12;
/// Largest triangle of three collinear points, as a fraction of the region's size squared.
constexpr double kCollinear = 1e-4;

}  // namespace

double ContactRegion::deepest() const {
  double depth = -1e300;
  for (int i = 0; i < count; ++i) depth = std::max(depth, (*this)[i].depth);
  return depth;
}

void ContactRegion::remove_gaps(double margin) {
  int kept = 0;
  for (int i = 0; i < count; ++i) {
    if ((*this)[i].depth >= -margin) (*this)[kept++] = (*this)[i];
  }
  count = kept;
}

/// Insertion sort: stable, without allocation, for at most twelve corners. Corners of a convex polygon are
/// ordered by their angle about any inner point, such as their mean.
void ContactRegion::sort_around() {
  double u = 0.0, v = 0.0;
  for (int i = 0; i < count; ++i) u += (*this)[i].place[0] / count, v += (*this)[i].place[1] / count;
  std::array<double, 12> angles{};
  for (int i = 0; i < count; ++i) {
    const RegionPoint point = (*this)[i];
    const double angle = std::atan2(point.place[1] - v, point.place[0] - u);
    int place = i;
    for (; place > 0 && angles[place - 1] > angle; --place) {
      (*this)[place] = (*this)[place - 1];
      angles[place] = angles[place - 1];
    }
    (*this)[place] = point;
    angles[place] = angle;
  }
}

void ContactRegion::erase(int i) {
  std::copy(points.begin() + i + 1, points.begin() + count, points.begin() + i);
  --count;
}

/// Twice the area that the region loses without corner i.
double ContactRegion::triangle(int i) const {
  return std::abs(
      cross((*this)[(i + count - 1) % count].place, (*this)[i].place, (*this)[(i + 1) % count].place));
}

/// The first of the deepest corners, in the polygon's order.
std::uint8_t ContactRegion::first_deepest() const {
  const double deep = deepest() - kSameDepth;
  return std::find_if(points.begin(), points.begin() + count,
                      [&](const RegionPoint& p) { return p.depth >= deep; })
      ->feature;
}

void ContactRegion::straighten() {
  if (count <= 2) return;
  const std::uint8_t kept = first_deepest();
  double longest = 0.0;
  const Place& first = (*this)[0].place;
  for (int i = 1; i < count; ++i)
    longest = std::max(longest, std::hypot((*this)[i].place[0] - first[0], (*this)[i].place[1] - first[1]));
  for (int i = count - 1; i >= 0 && count > 2; --i) {
    if ((*this)[i].feature != kept && triangle(i) < kCollinear * longest * longest) erase(i);
  }
}

/// Again and again the corner goes whose triangle with its neighbours is the least (Visvalingam & Whyatt
/// 1993). Triangles of regular regions are equal but for rounding: a later corner only beats an earlier one
/// by a noticeable part, and the round begins with the least name, wherever clipping began. So the same four
/// points, with their anchors, are kept from step to step.
void ContactRegion::reduce() {
  if (count <= 4) return;
  const auto by_feature = [](const RegionPoint& a, const RegionPoint& b) { return a.feature < b.feature; };
  std::rotate(points.begin(), std::min_element(points.begin(), points.begin() + count, by_feature),
              points.begin() + count);
  const std::uint8_t kept = first_deepest();
  while (count > 4) {
    int smallest = -1;
    double min_area = 0.0;
    for (int i = 0; i < count; ++i) {
      if ((*this)[i].feature == kept) continue;
      const double area = triangle(i);
      if (smallest >= 0 && area > (1.0 - kSameArea) * min_area - kNoArea) continue;
      smallest = i, min_area = area;
    }
    erase(smallest);
  }
}

// With p the distance of an edge's line from the middle, t along it from where it is nearest, and r that of
// its ends, the triangle of the middle and the edge has the area p (t_2 - t_1) / 2 and
//
//     integral of r dA = (p / 6) [ t_2 r_2 - t_1 r_1 + p^2 log((t_2 + r_2) / (t_1 + r_1)) ]
double spread_of(std::array<Place, 4> corners, int count) {
  if (count < 2) return 1.0;
  if (count == 2) return 0.5;
  // In order around: of four, such that both diagonals part the other two.
  if (count == 4) {
    const auto parts = [&](std::size_t i, std::size_t j, std::size_t k, std::size_t l) {
      return cross(corners[i], corners[j], corners[k]) * cross(corners[i], corners[j], corners[l]) < 0.0;
    };
    if (parts(0, 1, 2, 3)) {
      std::swap(corners[1], corners[2]);
    } else if (parts(0, 3, 1, 2)) {
      std::swap(corners[2], corners[3]);
    }
  }
  Place middle{};
  for (int i = 0; i < count; ++i)
    for (std::size_t k = 0; k < 2; ++k) middle[k] += corners[i][k] / count;
  std::array<double, 4> away{};
  for (int i = 0; i < count; ++i) {
    corners[i] = {corners[i][0] - middle[0], corners[i][1] - middle[1]};
    away[i] = std::sqrt(corners[i][0] * corners[i][0] + corners[i][1] * corners[i][1]);
  }
  double moment = 0.0, area = 0.0;
  for (int i = 0; i < count; ++i) {
    const int next = (i + 1) % count;
    const double x = corners[next][0] - corners[i][0], y = corners[next][1] - corners[i][1];
    const double length = std::sqrt(x * x + y * y);
    const double distance = cross({}, corners[i], corners[next]) / length;
    if (!(std::abs(distance) > 1e-9 * length)) continue;
    const double start = (x * corners[i][0] + y * corners[i][1]) / length, end = start + length;
    moment += distance / 6.0 *
              (end * away[next] - start * away[i] +
               distance * distance * std::log((end + away[next]) / (start + away[i])));
    area += 0.5 * distance * length;
  }
  const double of_corners = (away[0] + away[1] + away[2] + away[3]) / count;
  return area != 0.0 ? moment / area / of_corners : 0.5;
}

/// The direction is (0.137, 0.241, 0.961), of length 1 and square to nothing that is likely in a scene: faces
/// that meet exactly upright still have one that is below.
bool first_is_reference(double area_a, double area_b, const Vector3& normal) {
  if (std::abs(area_a - area_b) > kSameSize * (area_a + area_b)) return area_a > area_b;
  return 0.137 * normal.x() + 0.241 * normal.y() + 0.961 * normal.z() < 0.0;
}

/// Depth changes by slope per metre across the face, so that kDepth / slope changes it by 1 um.
double border_tolerance(double size, double slope) {
  constexpr double kMaxTolerance = 0.00015, kDepth = 1e-6;  // [m]
  return std::min({kMaxTolerance, 0.005 * size, kDepth / std::max(slope, 1e-12)});
}

}  // namespace mrhi
