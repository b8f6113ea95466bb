#include "free_flight.h"

#include <algorithm>
#include <cmath>

#include "../math/triple.h"
#include "mr_hand_interaction/integration/body_state.h"

namespace mrhi {

// I_w^-1 = R I^-1 R'.
Matrix3 world_inverse_inertia(const Body& body, const Quaternion& orientation) {
  const Matrix3 rotation = orientation.toRotationMatrix();
  return rotation * body.inverse_inertia * rotation.transpose();
}

// w = R I^-1 R' L. Momenta are the state, as flight conserves them; velocities follow from them. Uses the
// quaternion instead of R: two rotations of a vector, where I_w^-1 needs two matrix products.
Twist twist_of(const Body& body, const BodyState& state) {
  if (body.fixed) return {};
  const Quaternion& q = state.pose.orientation;
  const Vector3 body_momentum = q.conjugate() * state.angular_momentum;
  return {state.linear_momentum / body.mass, q * (body.inverse_inertia * body_momentum)};
}

BodyState start_state(const Body& body) {
  BodyState state;
  state.pose = body.start;
  if (body.fixed) return state;
  const Quaternion& q = state.pose.orientation;
  state.linear_momentum = body.mass * body.start_twist.linear;
  state.angular_momentum = q * (body.inertia * (q.conjugate() * body.start_twist.angular));
  return state;
}

// T = (p.v + L.w) / 2.
double kinetic_energy(const Body& body, const BodyState& state) {
  if (body.fixed) return 0.0;
  const Twist twist = twist_of(body, state);
  return 0.5 * (state.linear_momentum.dot(twist.linear) + state.angular_momentum.dot(twist.angular));
}

namespace {

/// Maximum number of parts of a step. A spin that needs more cannot be seen, and is shown slower.
constexpr double kMaxParts = 5000.0;
/// Square of an angular momentum that causes no visible rotation in a year [kg^2 m^4/s^2].
constexpr double kMinSquaredMomentum = 1e-200;

// 1/I_min - 1/I_max: |w x L| is at most this times |L|^2; 0 for a ball.
double spread(const Body& body) {
  return body.inverse_moments.maxCoeff() - body.inverse_moments.minCoeff();
}

/// Largest rotation of the momentum in the body in a part of a step [rad]: the series' remainders are below
/// rounding.
constexpr double kMaxPartPath = 0.025;
/// Largest rotation of the body about its momentum in a part of a step [rad].
constexpr double kMaxTurn = 0.25;

double series(double, double last) {
  return last;
}
/// first + x (second + x (third + ...)).
template <typename... Others>
double series(double x, double first, Others... others) {
  return first + x * series(x, others...);
}

/// Solution of Euler's equations from the momentum m along a body's principal axes, the second one
/// intermediate [kg m^2/s]. It follows the addition theorem of Jacobi's elliptic functions, written without
/// amplitudes: with J = 1/I, j = (J3 - J2, J1 - J3, J2 - J1), and S, c, d the functions of A = -j1 (j2 m3^2 -
/// j3 m2^2) and B = -j3 (j2 m1^2 - j1 m2^2) with S' = c d, c^2 = 1 - A S^2, d^2 = 1 - B S^2 (sn, cn and dn,
/// up to scale),
///
///     m1(t) = (m1 c + j1 m2 m3 S d) / D      D = 1 - j1 j3 m2^2 S^2
///     m2(t) = (m2 c d + j2 m1 m3 S) / D
///     m3(t) = (m3 d + j3 m1 m2 S c) / D
///
///     S = t - s t^3/3! + (s^2 + 12 p) t^5/5! - s (s^2 + 132 p) t^7/7!
///           + (s^2 (s^2 + 1224 p) + 3024 p^2) t^9/9!
///     s = A + B,  p = A B:      sn's series (Abramowitz & Stegun 16.22.1), for A = 1 and B = k^2
///
/// This holds for asymmetric and symmetric bodies and on the separatrix (A = B). The displacement n(t) = m(t)
/// - m avoids cancellation: small terms are sums of small terms, as in n1 = (m1 ((1 - D) - (1 - c)) + ...) /
/// D. Roots are series: A and B are not negative, as j1 and j3 have one sign and j2 the other.
class MomentumPath {
 public:
  MomentumPath(const Triple& m, const Triple& moments)
      : m_(m),
        j_{moments.z - moments.y, moments.x - moments.z, moments.y - moments.x},
        slope_(slope(m)),
        both_(j_.x * j_.z * (m.y * m.y)),
        a_(both_ - j_.x * j_.y * (m.z * m.z)),
        b_(both_ - j_.y * j_.z * (m.x * m.x)) {
    const double sum = a_ + b_, product = a_ * b_, squared = sum * sum;
    s3_ = -1.0 / 6.0 * sum;
    s5_ = 1.0 / 120.0 * squared + 12.0 / 120.0 * product;
    s7_ = sum * (-1.0 / 5040.0 * squared - 132.0 / 5040.0 * product);
    s9_ = 1.0 / 362880.0 * (squared * squared) +
          product * (1224.0 / 362880.0 * squared + 3024.0 / 362880.0 * product);
  }

  /// Displacement of the momentum after the time t.
  Triple after(double t) const {
    const double t2 = t * t;
    const double s = t + t * (t2 * (s3_ + t2 * (s5_ + t2 * (s7_ + t2 * s9_)))), q = s * s;
    const double za = a_ * q, zb = b_ * q, less = both_ * q;
    return at(s, za * series(za, 1.0 / 2.0, 1.0 / 8.0, 1.0 / 16.0, 5.0 / 128.0, 7.0 / 256.0),
              zb * series(zb, 1.0 / 2.0, 1.0 / 8.0, 1.0 / 16.0, 5.0 / 128.0, 7.0 / 256.0), less,
              1.0 / (1.0 - less));
  }
  /// The same to a relative error of 1e-12, for t of at most half a part.
  Triple nearly_after(double t) const {
    const double t2 = t * t, s = t + t * (t2 * (s3_ + t2 * (s5_ + t2 * s7_))), q = s * s;
    const double za = a_ * q, zb = b_ * q, less = both_ * q;
    return at(s, za * series(za, 1.0 / 2.0, 1.0 / 8.0, 1.0 / 16.0),
              zb * series(zb, 1.0 / 2.0, 1.0 / 8.0, 1.0 / 16.0), less, series(less, 1.0, 1.0, 1.0, 1.0));
  }
  /// Bound of the square of the rate at which the momentum turns in the body [1/s^2]; the same at any place
  /// of the path: A and B are integrals of the motion, and |m'|^2 <= (A + B) |m|^2. A slender body that
  /// tumbles end over end has a small one.
  double max_squared_rate() const { return a_ + b_; }
  /// Rate of a principal momentum.
  Triple slope(const Triple& m) const { return {j_.x * (m.y * m.z), j_.y * (m.x * m.z), j_.z * (m.x * m.y)}; }

 private:
  /// From 1 - c, 1 - d, 1 - D and 1 / D. An error of `s` moves the result along the path, so energy is
  /// conserved.
  Triple at(double s, double c_less, double d_less, double less, double scale) const {
    return {scale * (m_.x * (less - c_less) + slope_.x * s * (1.0 - d_less)),
            scale * (m_.y * (less - c_less - d_less + c_less * d_less) + slope_.y * s),
            scale * (m_.z * (less - d_less) + slope_.z * s * (1.0 - c_less))};
  }

  Triple m_, j_, slope_;
  double both_, a_, b_, s3_, s5_, s7_, s9_;
};

Triple each(const Triple& a, const Triple& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}

/// Rotation about the momentum, by twice an angle: the angle's cosine, and its sine over the momentum's size.
struct About {
  double cosine, sine;
};

/// `by_momentum` times the size of the momentum is the angle. Series for up to kMaxTurn.
About about(double by_momentum, double squared_momentum) {
  const double x = by_momentum * by_momentum * squared_momentum;  // square of the angle
  return {series(x, 1.0, -1.0 / 2.0, 1.0 / 24.0, -1.0 / 720.0, 1.0 / 40320.0, -1.0 / 3628800.0),
          by_momentum * series(x, 1.0, -1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0, 1.0 / 362880.0)};
}

/// The body rotates about the momentum by (Montgomery 1991: 2 E t / L less the area between the path of m and
/// its chord)
///
///     L * integral of (2 E + m . J m(t)) / (L^2 + m . m(t)) dt
///         = (2 E t + integral of n . k n / (4 (1 - e)) dt) / L,     e = n^2 / (4 L^2),  k = 2 E / L^2 - J
///
/// The second integral is small. Simpson's rule with the slopes at the ends is exact for it, to rounding.
///
/// |m + n| = |m| gives m.n = -n^2 / 2, so L^2 + m.m(t) = 2 L^2 (1 - e). Equal energy gives m.J n = -n.J n /
/// 2, so the numerator is 2 (2 E) - n.J n / 2. Subtracting 2 E / L^2 leaves n.k n / (4 L^2 (1 - e)). With f
/// this integrand, f and f' are 0 at the start, and
///
///     integral of f = t / 30 (16 f(t/2) + 7 f(t)) - t^2 / 60 f'(t)
About about(const MomentumPath& path, const Triple& m, const Triple& n, const Triple& moments, double over,
            double t) {
  const double over4 = 0.25 * over;
  const Triple rate = each(moments, m);
  const double twice_energy = rate.dot(m), mean = twice_energy * over;
  const Triple k{mean - moments.x, mean - moments.y, mean - moments.z};
  const Triple middle = path.nearly_after(0.5 * t);
  const double at_middle =
      each(k, middle).dot(middle) * series(over4 * middle.dot(middle), 1.0, 1.0, 1.0, 1.0);
  const Triple kn = each(k, n), slope = path.slope(m + n);
  const double grown = series(over4 * n.dot(n), 1.0, 1.0, 1.0, 1.0), at_end = kn.dot(n) * grown;
  const double half_slope = grown * (kn.dot(slope) + at_end * over4 * n.dot(slope));
  const double integral =
      t * (16.0 / 120.0 * at_middle + 7.0 / 120.0 * at_end) - t * t * (2.0 / 240.0 * half_slope);

  return about(0.5 * (t * twice_energy + integral) * over, m.dot(m));
}

/// Rotates q by the unit quaternion b = (cos, sine), with cos > 0. The increment is rounded once. Dividing
/// the product by its norm would round slow rotations alike in every step, and they would drift.
///
///     q <- q + q (b' - 1),      b' - 1 = ((1 + s) cos - 1, (1 + s) sine),      s = (1 - |q|^2) / 2
///     cos - 1 = -|sine|^2 / (1 + cos): no cancellation
///
/// s corrects the error of |q| to first order, so q is never divided by its norm.
void turn_on(double cosine, const Triple& sine, Quaternion& q) {
  const double w = q.w();
  const Triple u{q.x(), q.y(), q.z()};
  const double stretched = 0.5 * (1.0 - (w * w + u.dot(u)));
  const double w_more = stretched * cosine - sine.dot(sine) / (1.0 + cosine);
  const Triple vector = (1.0 + stretched) * sine;
  const Triple more = w * vector + w_more * u + u.cross(vector);
  q = Quaternion(w + (w_more * w - u.dot(vector)), u.x + more.x, u.y + more.y, u.z + more.z);
}

/// A vector in the body's axes.
Triple to_body(const Quaternion& q, const Triple& world) {
  const Triple u{q.x(), q.y(), q.z()}, across = world.cross(u), twice = across + across;
  return world + q.w() * twice + twice.cross(u);
}

/// A body's principal axes, in its frame.
struct PrincipalAxes {
  explicit PrincipalAxes(const Body& body)
      : x(triple(body.principal_axes.col(0))),
        y(triple(body.principal_axes.col(1))),
        z(triple(body.principal_axes.col(2))) {}
  Triple along(const Triple& v) const { return {x.dot(v), y.dot(v), z.dot(v)}; }
  Triple to_body(const Triple& v) const { return v.x * x + v.y * y + v.z * z; }

  Triple x, y, z;
};

/// Rotates the orientation by a part of a step, without roots and with few divisions: the shortest rotation
/// of the momentum's new direction in the body to its old one, then the rotation about it. The product has
/// the norm sqrt(1 - e) if the scalar part of the first is 1 - e and the vector of the second is along m + n
/// / 2.
///
///     (2 L^2 (1 - e), n x m)  then  (cos, sin m / L),  over 2 L^2:
///     scalar  cos (1 - e),     vector  cos n x m / 2 L^2 + sin / L (m + n / 2)
///
/// as m x (n x m) = n L^2 - m (m.n) = n L^2 + m n^2 / 2. cos and sin are those of half the angle; `sine`
/// includes 1 / L, so no root of L^2 is needed.
void turn_part(const Body& body, const Vector3& angular_momentum, double step, Quaternion& q) {
  const Triple local = to_body(q, triple(angular_momentum));
  if (spread(body) == 0.0) {
    // In a body with equal moments the momentum is constant; the body rotates about it at L / I.
    const About turn = about(0.5 * step * body.inverse_moments.x(), local.dot(local));
    return turn_on(turn.cosine, turn.sine * local, q);
  }
  const PrincipalAxes axes(body);
  const Triple m = axes.along(local), moments = triple(body.inverse_moments);
  const double over = 1.0 / m.dot(m);
  const MomentumPath path(m, moments);
  const Triple n = path.after(step);
  const About turn = about(path, m, n, moments, over, step);

  const double e = 0.25 * over * n.dot(n);
  const double root_over = series(e, 1.0, 1.0 / 2.0, 3.0 / 8.0, 5.0 / 16.0, 35.0 / 128.0);
  const double cosine = turn.cosine * root_over, sine = turn.sine * root_over;
  const Triple v = 0.5 * cosine * over * n.cross(m) + sine * (m + 0.5 * n);
  turn_on(cosine - cosine * e, axes.to_body(v), q);
}

/// Square of the number of parts that a step needs; less than 1 if it may be longer.
double squared_parts(const Body& body, const Vector3& angular_momentum, double step, const Quaternion& q) {
  const Triple m = PrincipalAxes(body).along(to_body(q, triple(angular_momentum)));
  const Triple moments = triple(body.inverse_moments);
  const double path = step / kMaxPartPath, turn = step / kMaxTurn * each(moments, m).dot(m);
  return std::max(path * path * MomentumPath(m, moments).max_squared_rate(), turn * turn / m.dot(m));
}

// x += h p / m + h^2 g / 2 with p at the start of the step, then p += m h g. If contacts were solved
// implicitly, the caller passes g = 0: p is then that of the end, and x += h v(h) is backward Euler's.
void fly_on(double mass, const Vector3& gravity, double step, BodyState& state) {
  const Vector3 velocity = state.linear_momentum / mass;
  state.pose.position += step * velocity + (0.5 * step * step) * gravity;
  state.linear_momentum += (mass * step) * gravity;
}

}  // namespace

// In parts of equal length: what limits them is the same all along the path. First by a bound that needs no
// root and no momentum in the body, and holds for most steps:
//
//     A + B <= (1/I_min - 1/I_max)^2 |L|^2,     2 E / |L| <= |L| / I_min
//
// The form !(x > y) is also true for NaN, and the minimum is the first of two if the second one is NaN.
void free_rotation(const Body& body, const Vector3& angular_momentum, double step, Quaternion& orientation) {
  const double squared = angular_momentum.squaredNorm();
  if (!(squared > kMinSquaredMomentum)) return;
  const double limit = std::max(spread(body) / kMaxPartPath, body.inverse_moments.maxCoeff() / kMaxTurn);
  const double bound = limit * limit * squared * (step * step);
  if (bound <= 1.0) return turn_part(body, angular_momentum, step, orientation);
  const double parts = std::sqrt(std::min(bound, squared_parts(body, angular_momentum, step, orientation)));
  const double count = std::clamp(std::ceil(parts), 1.0, kMaxParts);
  for (int i = 0; i < static_cast<int>(count); ++i)
    turn_part(body, angular_momentum, step / std::max(parts, count), orientation);
}

// Exact for any step: a parabola, and Euler's equations in closed form. The angular momentum in world axes is
// unchanged; only the axes rotate.
void free_flight(const Body& body, const Vector3& gravity, double step, BodyState& state) {
  if (!body.flies) return;
  fly_on(body.mass, gravity, step, state);
  free_rotation(body, state.angular_momentum, step, state.pose.orientation);
}

}  // namespace mrhi
