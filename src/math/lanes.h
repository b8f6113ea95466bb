#pragma once

#include <cmath>

namespace mrhi {

/// Numbers of four contacts side by side, in memory.
/// Four is what a register of AVX2 holds, and two of SSE2's.
constexpr int kLanes = 4;
struct alignas(32) Lanes {
  double lane[kLanes];
};

// This is compiled for any processor and once more for those with wider registers. No function of the one may
// end up in the other's place, so all that is not a template of `Wide` stands in a namespace of its own.
#ifdef __AVX2__
// By the name of the namespace the linker tells the two copies apart. Had they the same name it would keep
// one of them (ODR), and might take the AVX2 one for processors that have none.
inline namespace avx2 {
constexpr int kParts = 1;
#else
inline namespace portable {
constexpr int kParts = 2;
#endif

/// Four numbers in registers. Every operation works lane by lane, each as exact as on a double, so that a law
/// written for a `Real` gives the same bits on a double and on a lane, whatever the registers.
/// What it takes for that: no multiply and add fused into one (-ffp-contract=off), since that rounds once
/// where the other rounds twice; and only operations that IEEE 754 rounds correctly: + - * / and the root.
struct [[gnu::may_alias]] alignas(Lanes) Wide {
  using Part [[gnu::vector_size(sizeof(Lanes) / kParts)]] = double;
  Part part[kParts];
};
static_assert(sizeof(Wide) == sizeof(Lanes), "what is stored as the one is worked on as the other");

/// What is stored in lanes, to be worked on.
template <template <typename> class Of>
Of<Wide>& wide(Of<Lanes>& stored) {
  return reinterpret_cast<Of<Wide>&>(stored);
}
template <template <typename> class Of>
const Of<Wide>& wide(const Of<Lanes>& stored) {
  return reinterpret_cast<const Of<Wide>&>(stored);
}

inline Wide side_by_side(double a, double b, double c, double d) {
  const Lanes lanes{{a, b, c, d}};
  return reinterpret_cast<const Wide&>(lanes);
}
inline double lane_of(int lane, const Lanes& lanes) {
  return lanes.lane[lane];
}
/// By its parts: read as doubles, what is still on its way there would be missed (strict aliasing; gcc 10
/// does).
inline double lane_of(int lane, const Wide& lanes) {
  constexpr int kEach = kLanes / kParts;
  return lanes.part[lane / kEach][lane % kEach];
}
/// Sum over the lanes, always in this order.
inline double sum(const Wide& a) {
  return (lane_of(0, a) + lane_of(1, a)) + (lane_of(2, a) + lane_of(3, a));
}

template <typename Operation>
inline Wide by_parts(Operation operation) {
  Wide result;
  for (int i = 0; i < kParts; ++i) result.part[i] = operation(i);
  return result;
}
inline Wide operator+(const Wide& a, const Wide& b) {
  return by_parts([&](int i) { return a.part[i] + b.part[i]; });
}
inline Wide operator-(const Wide& a, const Wide& b) {
  return by_parts([&](int i) { return a.part[i] - b.part[i]; });
}
inline Wide operator*(const Wide& a, const Wide& b) {
  return by_parts([&](int i) { return a.part[i] * b.part[i]; });
}
inline Wide operator/(const Wide& a, const Wide& b) {
  return by_parts([&](int i) { return a.part[i] / b.part[i]; });
}
// Both sides of every choice are worked out and one is taken (no branch by lane): the side that is not
// taken may be infinite or no number, and must not be used otherwise. lesser() and greater() of equals give
// `a`, on doubles as on lanes, so that the sign of a zero is the same too.
inline Wide lesser(const Wide& a, const Wide& b) {
  return by_parts([&](int i) { return b.part[i] < a.part[i] ? b.part[i] : a.part[i]; });
}
inline Wide greater(const Wide& a, const Wide& b) {
  return by_parts([&](int i) { return a.part[i] < b.part[i] ? b.part[i] : a.part[i]; });
}
inline Wide where_at_most(const Wide& a, const Wide& b, const Wide& yes, const Wide& no) {
  return by_parts([&](int i) { return a.part[i] <= b.part[i] ? yes.part[i] : no.part[i]; });
}
inline Wide root(const Wide& a) {
  Wide result;
  for (Wide::Part& part : result.part) {
    const Wide::Part& of = a.part[&part - result.part];
    for (int i = 0; i < kLanes / kParts; ++i) part[i] = std::sqrt(of[i]);
  }
  return result;
}
inline double lesser(double a, double b) {
  return b < a ? b : a;
}
inline double greater(double a, double b) {
  return a < b ? b : a;
}
inline double where_at_most(double a, double b, double yes, double no) {
  return a <= b ? yes : no;
}
inline double root(double a) {
  return std::sqrt(a);
}
inline bool any_above(double a, double b) {
  return a > b;
}

template <typename Real>
Real constant(double value);
template <>
inline double constant<double>(double value) {
  return value;
}
template <>
inline Wide constant<Wide>(double value) {
  return side_by_side(value, value, value, value);
}
inline bool any_above(const Wide& a, const Wide& b) {
  // Counts the lanes that are above: four ones add up exactly.
  return sum(where_at_most(a, b, constant<Wide>(0.0), constant<Wide>(1.0))) > 0.0;
}
}  // namespace

/// A vector, or one of each lane.
template <typename Real>
struct Triple {
  Real x, y, z;

  Real dot(const Triple& o) const { return x * o.x + y * o.y + z * o.z; }
  Triple cross(const Triple& o) const { return {y * o.z - z * o.y, z * o.x - x * o.z, x * o.y - y * o.x}; }
  Triple operator+(const Triple& o) const { return {x + o.x, y + o.y, z + o.z}; }
  Triple operator-(const Triple& o) const { return {x - o.x, y - o.y, z - o.z}; }
  friend Triple operator*(const Real& s, const Triple& v) { return {s * v.x, s * v.y, s * v.z}; }
};

}  // namespace mrhi
