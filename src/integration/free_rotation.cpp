#include "free_rotation.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mrhi {
namespace {

/// Within this, S is its series to the ninth order, to rounding [rad].
constexpr double kSeries = 1.0 / 32.0;

using Array = Eigen::Array4d;

/// S at times of which none is beyond a quarter of a period.
///
///     S = t - s t^3/3! + (s^2 + 12 p) t^5/5! - s (s^2 + 132 p) t^7/7!
///           + (s^2 (s^2 + 1224 p) + 3024 p^2) t^9/9!
///     s = A + B,  p = A B:      sn's series (Abramowitz & Stegun 16.22.1), for A = 1 and B = k^2
///     S(2t) = 2 S c d / (1 - p S^4)
///
/// The time is halved until the series suffices and S doubled as often. With roots of c^2 and d^2 in it
/// this knows S, c, d > 0 alone: hence no more than a quarter of a period.
Array elliptic(double a, double b, Array times, double longest) {
  double part = 1.0;
  for (double angle = std::sqrt(std::max(a, b)) * longest; part * angle > kSeries;) part *= 0.5;
  times *= part;
  const double s = a + b, p = a * b;
  const double s3 = -s / 6.0, s5 = (s * s + 12.0 * p) / 120.0, s7 = -s * (s * s + 132.0 * p) / 5040.0,
               s9 = (s * s * (s * s + 1224.0 * p) + 3024.0 * p * p) / 362880.0;
  const Array squares = times * times;
  Array result = times + times * squares * (s3 + squares * (s5 + squares * (s7 + squares * s9)));
  for (; part < 1.0; part *= 2.0) {
    const Array q = result * result;
    result *= 2.0 * ((1.0 - a * q) * (1.0 - b * q)).sqrt() / (1.0 - p * q * q);
  }
  return result;
}

/// Lobatto's rule on 0 to 1. The point 0 is left out; its weight is that of 1, which comes last.
Array points() {
  return {0.17267316464601142810, 0.5, 0.82732683535398857190, 1.0};
}
/// Exact for polynomials of the seventh degree, by four values beside that at 0, which is known.
Array weights() {
  return {49.0 / 180.0, 64.0 / 180.0, 49.0 / 180.0, 9.0 / 180.0};
}

/// cos x, sin x.
std::pair<double, double> cosine_and_sine(double x) {
  if (std::abs(x) > 0.25) return {std::cos(x), std::sin(x)};
  const double y = x * x;
  const double cosine =
      1.0 -
      y / 2.0 * (1.0 - y / 12.0 * (1.0 - y / 30.0 * (1.0 - y / 56.0 * (1.0 - y / 90.0 * (1.0 - y / 132.0)))));
  const double sine =
      x * (1.0 - y / 6.0 * (1.0 - y / 20.0 * (1.0 - y / 42.0 * (1.0 - y / 72.0 * (1.0 - y / 110.0)))));
  return {cosine, sine};
}

/// How far the momentum goes in the body, and by what the body turns about it.
struct Travel {
  Vector3 of_momentum;
  double angle;  // [rad]
};

// With n(t) = m(t) - m(0), 1 - D = j1 j3 m2^2 S^2 (`less`) and the addition theorems
//
//     1 - c(2t) = 2 A S^2 d^2 / (1 - p S^4),     1 - d(2t) = 2 B S^2 c^2 / (1 - p S^4)         S, c, d at t
//
// m1 is put as (m1 (c - D) + ...) / D, c - D = (1 - D) - (1 - c): what is small is summed of small parts. A
// and B are not negative, as j1 and j3 have one sign and j2 the other; two equal moments (a j of 0) and the
// separatrix (A = B) are no cases of their own.
Travel travel_of(const Vector3& inverse_moments, const Vector3& momentum, double step) {
  const double m1 = momentum[0], m2 = momentum[1], m3 = momentum[2];
  const double j1 = inverse_moments[2] - inverse_moments[1], j2 = inverse_moments[0] - inverse_moments[2],
               j3 = inverse_moments[1] - inverse_moments[0];
  const double both = j1 * j3 * m2 * m2;
  const double a = both - j1 * j2 * m3 * m3, b = both - j2 * j3 * m1 * m1;

  // 1 - c and 1 - d from half the time, and how far the momentum goes, not where: nothing cancels, and what
  // is rounded is small.
  const Array half = elliptic(a, b, (0.5 * step) * points(), 0.5 * step);
  const Array q = half * half, c_squared = 1.0 - a * q, d_squared = 1.0 - b * q;
  const Array over = 1.0 / (1.0 - (a * b) * q * q);
  const Array c_less = (2.0 * a) * q * d_squared * over, d_less = (2.0 * b) * q * c_squared * over;
  const Array s = 2.0 * half * (c_squared * d_squared).sqrt() * over;
  const Array less = both * s * s, scale = 1.0 / (1.0 - less);
  const Array n1 = (m1 * (less - c_less) + (j1 * m2 * m3) * s * (1.0 - d_less)) * scale;
  const Array n2 = (m2 * (less - c_less - d_less + c_less * d_less) + (j2 * m1 * m3) * s) * scale;
  const Array n3 = (m3 * (less - d_less) + (j3 * m1 * m2) * s * (1.0 - c_less)) * scale;

  const double squared = momentum.squaredNorm(), size = std::sqrt(squared);
  const Vector3 rate = inverse_moments.cwiseProduct(momentum);
  const double twice_energy = momentum.dot(rate);
  const Array about = (2.0 * twice_energy + rate[0] * n1 + rate[1] * n2 + rate[2] * n3) /
                      (2.0 * squared + m1 * n1 + m2 * n2 + m3 * n3);

  Travel travel;
  const Eigen::Index last = n1.size() - 1;
  travel.of_momentum = Vector3(n1[last], n2[last], n3[last]);
  travel.angle = size * step * ((weights() * about).sum() + weights()[last] * (twice_energy / squared));
  return travel;
}

}  // namespace

//     turn by `angle` about m,  after  (m(0).m(t) + L^2, m(t) x m(0)):  the shortest from m(t) to m(0)
//
// With n = m(t) - m(0), m(t) x m(0) = n x m and the scalar part 2 L^2 + m.n, which is not small: m(t) is
// near m.
Quaternion free_rotation(const Vector3& inverse_moments, const Vector3& momentum, double step) {
  const double squared = momentum.squaredNorm(), size = std::sqrt(squared);
  const bool equal = inverse_moments.maxCoeff() == inverse_moments.minCoeff();
  const Travel travel = equal ? Travel{Vector3::Zero(), inverse_moments[0] * size * step}
                              : travel_of(inverse_moments, momentum, step);
  // Takes the momentum's new place in the body to its old one the shortest travel, and turns about it.
  const Vector3 cross = travel.of_momentum.cross(momentum);
  const double dot = 2.0 * squared + momentum.dot(travel.of_momentum);
  const auto [cosine, sine] = cosine_and_sine(0.5 * travel.angle);
  Quaternion turned;
  turned.w() = cosine * dot;  // the cross product is across the momentum
  turned.vec() = cosine * cross + (sine / size) * (dot * momentum + momentum.cross(cross));
  return turned;
}

}  // namespace mrhi
