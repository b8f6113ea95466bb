#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// Four contacts side by side. Every operation works lane by lane, each as exact as on a double, so that a
/// law written for a `Real` gives the same bits on a double and on a lane.
using Lanes = Eigen::Array<double, 4, 1>;
constexpr int kLanes = 4;

inline double lesser(double a, double b) {
  return std::min(a, b);
}
inline double greater(double a, double b) {
  return std::max(a, b);
}
inline double root(double a) {
  return std::sqrt(a);
}
inline double where_at_most(double a, double b, double yes, double no) {
  return a <= b ? yes : no;
}
inline bool any_above(double a, double b) {
  return a > b;
}

inline Lanes lesser(const Lanes& a, const Lanes& b) {
  return a.min(b);
}
inline Lanes greater(const Lanes& a, const Lanes& b) {
  return a.max(b);
}
inline Lanes root(const Lanes& a) {
  return a.sqrt();
}
inline Lanes where_at_most(const Lanes& a, const Lanes& b, const Lanes& yes, const Lanes& no) {
  return (a <= b).select(yes, no);
}
inline bool any_above(const Lanes& a, const Lanes& b) {
  return (a > b).any();
}

/// Sum over the lanes, always in this order.
inline double sum(const Lanes& a) {
  return (a[0] + a[1]) + (a[2] + a[3]);
}

template <typename Real>
Real constant(double value);
template <>
inline double constant<double>(double value) {
  return value;
}
template <>
inline Lanes constant<Lanes>(double value) {
  return Lanes::Constant(value);
}

/// A vector of each lane.
template <typename Real>
struct Triple {
  Real x, y, z;

  Real dot(const Triple& o) const { return x * o.x + y * o.y + z * o.z; }
  Triple cross(const Triple& o) const {
    return {Real(y * o.z - z * o.y), Real(z * o.x - x * o.z), Real(x * o.y - y * o.x)};
  }
  Triple operator+(const Triple& o) const { return {Real(x + o.x), Real(y + o.y), Real(z + o.z)}; }
  Triple operator-(const Triple& o) const { return {Real(x - o.x), Real(y - o.y), Real(z - o.z)}; }
  friend Triple operator*(const Real& s, const Triple& v) {
    return {Real(s * v.x), Real(s * v.y), Real(s * v.z)};
  }
};

inline Triple<double> triple(const Vector3& v) {
  return {v.x(), v.y(), v.z()};
}
inline Vector3 vector(const Triple<double>& v) {
  return {v.x, v.y, v.z};
}

/// Puts a vector into a lane, and takes one out.
inline void set_lane(int lane, const Vector3& v, Triple<Lanes>& lanes) {
  lanes.x[lane] = v.x(), lanes.y[lane] = v.y(), lanes.z[lane] = v.z();
}
inline Vector3 lane_of(int lane, const Triple<Lanes>& lanes) {
  return {lanes.x[lane], lanes.y[lane], lanes.z[lane]};
}
inline Vector3 sum(const Triple<Lanes>& v) {
  return {sum(v.x), sum(v.y), sum(v.z)};
}
/// The same vector in every lane.
inline Triple<Lanes> everywhere(const Vector3& v) {
  return {Lanes::Constant(v.x()), Lanes::Constant(v.y()), Lanes::Constant(v.z())};
}

}  // namespace mrhi
