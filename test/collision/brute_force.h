#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// Convex shapes as a generic search sees them: the surface point farthest along a direction, and the point
/// nearest to a place.
struct PointShape {
  Vector3 farthest(const Vector3&) const { return Vector3::Zero(); }
  Vector3 nearest(const Vector3&) const { return Vector3::Zero(); }
};
struct BoxShape {
  Vector3 half;
  Vector3 farthest(const Vector3& n) const {
    return {n.x() < 0 ? -half.x() : half.x(), n.y() < 0 ? -half.y() : half.y(),
            n.z() < 0 ? -half.z() : half.z()};
  }
  Vector3 nearest(const Vector3& place) const { return place.cwiseMin(half).cwiseMax(-half); }
};
struct CylinderShape {
  double radius, half_length;
  Vector3 farthest(const Vector3& n) const {
    const double level = std::hypot(n.x(), n.y()), scale = level > 0 ? radius / level : 0;
    return {scale * n.x(), scale * n.y(), n.z() < 0 ? -half_length : half_length};
  }
  Vector3 nearest(const Vector3& place) const {
    const double scale = std::min(1.0, radius / std::max(1e-300, std::hypot(place.x(), place.y())));
    return {scale * place.x(), scale * place.y(), std::min(half_length, std::max(-half_length, place.z()))};
  }
};

/// Where in 0..1 a convex function is least, by golden section.
template <typename Function>
double golden_section(const Function& f) {
  constexpr double kGolden = 0.6180339887498949;
  double lo = 0, hi = 1, a = 1 - kGolden, b = kGolden, fa = f(a), fb = f(b);
  for (int i = 0; i < 80; ++i) {
    if (fa < fb) {
      hi = b, b = a, fb = fa, a = hi - kGolden * (hi - lo), fa = f(a);
    } else {
      lo = a, a = b, fa = fb, b = lo + kGolden * (hi - lo), fb = f(b);
    }
  }
  double best = 0.5 * (lo + hi);
  for (const double end : {0.0, 1.0}) {
    if (f(end) <= f(best)) best = end;
  }
  return best;
}

/// The least translation that takes a capsule's axis out of a convex shape, by branch and bound over all
/// directions: every triangle of the sphere of directions is split until it is proven not to hold a better
/// one.
template <typename ShapeType>
class LeastTranslation {
 public:
  LeastTranslation(const Capsule& capsule, const ShapeType& shape) : capsule_(capsule), shape_(shape) {
    const Vector3 x = Vector3::UnitX(), y = Vector3::UnitY(), z = Vector3::UnitZ();
    for (const double i : {-1.0, 1.0}) {
      for (const double j : {-1.0, 1.0}) {
        for (const double k : {-1.0, 1.0}) push({corner(i * x), corner(j * y), corner(k * z)});
      }
    }
    search();
  }

  /// A direction more than kSameDirection from `normal` is proven to need more than kWorse beyond `length`.
  bool unique() const { return unique_; }
  bool finished() const { return splits_ < kMaxSplits; }
  double length() const { return length_; }
  const Vector3& normal() const { return normal_; }

  static constexpr double kExact = 1e-11;           // of the length found [m]
  static constexpr double kWorse = 1e-12;           // [m]
  static constexpr double kSameDirection = 1.5e-4;  // [rad], under 0.01 degrees

 private:
  static constexpr int kMaxSplits = 20000;

  /// A direction and the point of (shape - axis) that is farthest along it.
  struct Corner {
    Vector3 direction, farthest;
  };
  struct Triangle {
    std::array<Corner, 3> corners;
    double bound;
    bool operator<(const Triangle& other) const { return bound > other.bound; }
  };

  Corner corner(const Vector3& along) {
    const Vector3 n = along.normalized();
    const Vector3& trailing = n.dot(capsule_.start) < n.dot(capsule_.end) ? capsule_.start : capsule_.end;
    const Vector3 farthest = shape_.farthest(n) - trailing;
    const double length = n.dot(farthest);
    if (length < length_) length_ = length, normal_ = n;
    return {n, farthest};
  }

  /// No direction in the triangle needs less: a linear function is least at a corner, for any mixture of the
  /// corners' farthest points. Tried: each point, and the mixtures of two and of three that are as long in
  /// two and in three directions.
  static double bound(const std::array<Corner, 3>& corners) {
    Matrix3 lengths;  // (point, direction)
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) lengths(i, j) = corners[i].farthest.dot(corners[j].direction);
    }
    double best = lengths.rowwise().minCoeff().maxCoeff();
    const auto mix = [&](const Vector3& weights) {
      if (weights.minCoeff() < 0 || weights.sum() <= 0) return;
      best = std::max(best, (weights.transpose() * lengths).minCoeff() / weights.sum());
    };
    const Vector3 all = (lengths.col(0) - lengths.col(1)).cross(Vector3(lengths.col(1) - lengths.col(2)));
    mix(all.sum() < 0 ? Vector3(-all) : all);
    for (int j = 0; j < 3; ++j) {
      const Vector3 difference = lengths.col(j) - lengths.col((j + 1) % 3);
      for (int i = 0; i < 3; ++i) {
        const int k = (i + 1) % 3;
        Vector3 pair = Vector3::Zero();
        pair[i] = std::abs(difference[k]), pair[k] = std::abs(difference[i]);
        if (difference[i] * difference[k] < 0) mix(pair);
      }
    }
    return best < 0 ? 2 * best : best;  // directions inside the triangle are shorter than 1, not than 1/2
  }

  void push(const std::array<Corner, 3>& corners) {
    heap_.push_back({corners, bound(corners)});
    std::push_heap(heap_.begin(), heap_.end());
  }

  static double angle(const Vector3& a, const Vector3& b) { return (a - b).norm(); }
  bool near_best(const Triangle& triangle) const {
    return std::all_of(triangle.corners.begin(), triangle.corners.end(),
                       [&](const Corner& c) { return angle(c.direction, normal_) < kSameDirection; });
  }

  void search() {
    while (!heap_.empty() && heap_.front().bound < length_ + kWorse && finished()) {
      std::pop_heap(heap_.begin(), heap_.end());
      const Triangle triangle = heap_.back();
      heap_.pop_back();
      const auto& c = triangle.corners;
      if (triangle.bound >= length_ - kExact) {
        if (near_best(triangle)) continue;
        if (!unique_ || angle(c[0].direction, c[1].direction) < 1e-5) {
          unique_ = false;
          continue;
        }
      }
      ++splits_;
      const std::array<Corner, 3> m{{corner(c[0].direction + c[1].direction),
                                     corner(c[1].direction + c[2].direction),
                                     corner(c[2].direction + c[0].direction)}};
      push({c[0], m[0], m[2]});
      push({c[1], m[1], m[0]});
      push({c[2], m[2], m[1]});
      push({m[0], m[1], m[2]});
    }
  }

  const Capsule& capsule_;
  const ShapeType& shape_;
  std::vector<Triangle> heap_;
  double length_ = 1e300;
  Vector3 normal_ = Vector3::UnitX();
  bool unique_ = true;
  int splits_ = 0;
};

}  // namespace mrhi
