#include "mr_hand_interaction/collision/way_out.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mrhi {
namespace {

/// A line that runs along a side at this distance from it still meets the shape [m].
constexpr double kBorder = 1e-9;
/// Components of the direction below this are rounding.
constexpr double kParallel = 1e-12;

/// The part of a line that is inside.
struct Chord {
  double in = -std::numeric_limits<double>::infinity(), out = -in;

  void clip(double from, double to) { in = std::max(in, from), out = std::min(out, to); }
  void clip_to_slab(double x, double dx, double half) {
    if (std::abs(dx) < kParallel) {
      if (std::abs(x) > half + kBorder) out = -std::numeric_limits<double>::infinity();
      return;
    }
    const double a = (-half - x) / dx, b = (half - x) / dx;
    clip(std::min(a, b), std::max(a, b));
  }
  /// Keeps what is within `radius` of the origin, in as many dimensions as the line is given in.
  template <class Vector>
  void clip_to_ball(const Vector& x, const Vector& dx, double radius) {
    const double length = dx.norm();
    if (length < kParallel) {
      if (x.norm() > radius + kBorder) out = -std::numeric_limits<double>::infinity();
      return;
    }
    const double nearest = -x.dot(dx) / (length * length);
    const double miss = (x + nearest * dx).norm();
    if (miss > radius + kBorder) out = -std::numeric_limits<double>::infinity();
    const double half = std::sqrt(std::max(0.0, radius * radius - miss * miss)) / length;
    clip(nearest - half, nearest + half);
  }
};

struct ChordOf {
  const Vector3& point;
  const Vector3& direction;

  Chord operator()(const Sphere& sphere) const {
    Chord chord;
    chord.clip_to_ball(point, direction, sphere.radius);
    return chord;
  }
  Chord operator()(const Box& box) const {
    Chord chord;
    for (int i = 0; i < 3; ++i) chord.clip_to_slab(point[i], direction[i], box.half_extents[i]);
    return chord;
  }
  Chord operator()(const Cylinder& cylinder) const {
    Chord chord;
    chord.clip_to_slab(point.z(), direction.z(), cylinder.half_length);
    chord.clip_to_ball(Eigen::Vector2d(point.head<2>()), Eigen::Vector2d(direction.head<2>()),
                       cylinder.radius);
    return chord;
  }
  Chord operator()(const Mesh&) const { return {0.0, -1.0}; }
};

}  // namespace

std::optional<double> way_out(const Shape& shape, const Vector3& point, const Vector3& direction) {
  const Chord chord = std::visit(ChordOf{point, direction}, shape);
  if (chord.out < chord.in) return std::nullopt;
  return chord.out;
}

}  // namespace mrhi
