#include "free_flight.h"

#include <algorithm>
#include <cmath>
#include <utility>

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

/// Largest angle at which the series of S to ninth order is exact to rounding [rad].
constexpr double kSeries = 1.0 / 32.0;

using Array = Eigen::Array4d;

/// S at times of at most a quarter of a period.
///
///     S = t - s t^3/3! + (s^2 + 12 p) t^5/5! - s (s^2 + 132 p) t^7/7!
///           + (s^2 (s^2 + 1224 p) + 3024 p^2) t^9/9!
///     s = A + B,  p = A B:      sn's series (Abramowitz & Stegun 16.22.1), for A = 1 and B = k^2
///     S(2t) = 2 S c d / (1 - p S^4)
///
/// The time is halved until the series suffices, and S doubled as often. The doubling uses roots of c^2 and
/// d^2, so it needs S, c, d > 0: hence the limit of a quarter of a period.
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

/// Nodes of Lobatto's rule on [0, 1], without 0; the weight of 0 is that of 1, the last node.
Array points() {
  return {0.17267316464601142810, 0.5, 0.82732683535398857190, 1.0};
}
/// Weights, exact for polynomials of degree seven, of four values besides the known one at 0.
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

/// Displacement of the momentum in the body, and rotation of the body about the momentum.
struct Travel {
  Vector3 of_momentum;
  double angle;  // [rad]
};

// With n(t) = m(t) - m(0), 1 - D = j1 j3 m2^2 S^2 (`less`) and the addition theorems
//
//     1 - c(2t) = 2 A S^2 d^2 / (1 - p S^4),     1 - d(2t) = 2 B S^2 c^2 / (1 - p S^4)         S, c, d at t
//
// m1 is written as (m1 (c - D) + ...) / D, c - D = (1 - D) - (1 - c): small terms are sums of small terms. A
// and B are not negative, as j1 and j3 have one sign and j2 the other. Two equal moments (a j of 0) and the
// separatrix (A = B) need no special cases.
Travel travel_of(const Vector3& inverse_moments, const Vector3& momentum, double step) {
  const double m1 = momentum[0], m2 = momentum[1], m3 = momentum[2];
  const double j1 = inverse_moments[2] - inverse_moments[1], j2 = inverse_moments[0] - inverse_moments[2],
               j3 = inverse_moments[1] - inverse_moments[0];
  const double both = j1 * j3 * m2 * m2;
  const double a = both - j1 * j2 * m3 * m3, b = both - j2 * j3 * m1 * m1;

  // 1 - c and 1 - d from half the time, and the momentum's displacement instead of its value, avoid
  // cancellation, so rounding errors are relatively small.
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

/// Largest rotation of `momentum` in the body in one free_rotation() [rad].
constexpr double kFreeTurn = 0.25;

/// Rotation of a torque-free body in `step` seconds: final body axes relative to the initial ones.
/// `inverse_moments` are 1/I along its principal axes [1/(kg m^2)], which are the axes here, the second one
/// intermediate. `momentum` is its angular momentum in them at the start of the step [kg m^2/s], not zero.
///
/// The result is not normalised: the caller divides by its norm. Exact to rounding for rotations of up to
/// about kFreeTurn.
///
/// The momentum follows the addition theorem of Jacobi's elliptic functions, written without amplitudes: with
/// J = 1/I, j = (J3 - J2, J1 - J3, J2 - J1), 2 the intermediate axis, and S, c, d the functions of A = -j1
/// (j2 m3^2 - j3 m2^2) and B = -j3 (j2 m1^2 - j1 m2^2) with S' = c d, c^2 = 1 - A S^2, d^2 = 1 - B S^2 (sn,
/// cn and dn, up to scale),
///
///     m1(t) = (m1 c + j1 m2 m3 S d) / D      D = 1 - j1 j3 m2^2 S^2
///     m2(t) = (m2 c d + j2 m1 m3 S) / D
///     m3(t) = (m3 d + j3 m1 m2 S c) / D
///
/// This holds for asymmetric and symmetric bodies and on the separatrix. The body rotates about the momentum
/// by (Montgomery 1991: 2 E t / L less the area between the path of m and its chord)
///
///     L * integral of (2 E + m(0) . J m(t)) / (L^2 + m(0) . m(t)) dt,
///
/// evaluated by Lobatto's five nodes, which are exact to rounding within a step. Short rotations have their
/// own algorithm (turn_shortly).
///
///     turn by `angle` about m,  after  (m(0).m(t) + L^2, m(t) x m(0)):  the shortest from m(t) to m(0)
///
/// With n = m(t) - m(0), m(t) x m(0) = n x m, and the scalar part 2 L^2 + m.n is not small, as m(t) is near
/// m.
Quaternion free_rotation(const Vector3& inverse_moments, const Vector3& momentum, double step) {
  const double squared = momentum.squaredNorm(), size = std::sqrt(squared);
  const bool equal = inverse_moments.maxCoeff() == inverse_moments.minCoeff();
  const Travel travel = equal ? Travel{Vector3::Zero(), inverse_moments[0] * size * step}
                              : travel_of(inverse_moments, momentum, step);
  // The shortest rotation from the momentum's new direction in the body to its old one, then the rotation
  // about it.
  const Vector3 cross = travel.of_momentum.cross(momentum);
  const double dot = 2.0 * squared + momentum.dot(travel.of_momentum);
  const auto [cosine, sine] = cosine_and_sine(0.5 * travel.angle);
  Quaternion turned;
  turned.w() = cosine * dot;  // the cross product is perpendicular to the momentum
  turned.vec() = cosine * cross + (sine / size) * (dot * momentum + momentum.cross(cross));
  return turned;
}

/// Maximum number of parts of a step: spins that need more cannot be seen.
constexpr double kMaxParts = 1000.0;
/// Square of an angular momentum that causes no visible rotation in a year [kg^2 m^4/s^2].
constexpr double kMinSquaredMomentum = 1e-200;

/// Rotates `orientation` by `by`, which need not be unit. The increment is rounded once. Dividing the product
/// by its norm would round slow rotations alike in every step, and they would drift.
///
///     q <- q + q (b - 1),      b - 1 = ((1 + s) cos - 1, (1 + s) sin),      s = (1 - |q|^2) / 2
///     cos - 1 = -sin^2 / (1 + cos)           where cos > 0: no cancellation
///
/// s corrects the error of |q| to first order, so q is never divided by its norm.
void turn_on(const Quaternion& by, Quaternion& orientation) {
  const double scale = 1.0 / by.norm();
  Quaternion change(scale * by.w(), scale * by.x(), scale * by.y(), scale * by.z());
  const double sine_squared = change.vec().squaredNorm();
  const double stretched = 0.5 * (1.0 - orientation.squaredNorm());
  const double cosine = change.w();
  change.w() = (cosine > 0.0 ? -sine_squared / (1.0 + cosine) : cosine - 1.0) + stretched * cosine;
  change.vec() *= 1.0 + stretched;
  orientation.coeffs() += (orientation * change).coeffs();
}

// 1/I_min - 1/I_max: |w x L| is at most this times |L|^2; 0 for a ball.
double spread(const Body& body) {
  return body.inverse_moments.maxCoeff() - body.inverse_moments.minCoeff();
}

/// Largest rotation of the momentum in the body in a short rotation [rad]: the series' remainders are below
/// rounding.
constexpr double kShortPath = 0.025;
/// Largest rotation of the body in a short rotation [rad].
constexpr double kShortAngle = 0.25;

double series(double, double last) {
  return last;
}
/// first + x (second + x (third + ...)).
template <typename... Others>
double series(double x, double first, Others... others) {
  return first + x * series(x, others...);
}

/// Solution of Euler's equations from the principal momentum m, as in free_rotation(). Series as in
/// elliptic(), but without halving, which short rotations do not need.
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
  /// The same to a relative error of 1e-12, for t of at most half a short rotation.
  Triple nearly_after(double t) const {
    const double t2 = t * t, s = t + t * (t2 * (s3_ + t2 * (s5_ + t2 * s7_))), q = s * s;
    const double za = a_ * q, zb = b_ * q, less = both_ * q;
    return at(s, za * series(za, 1.0 / 2.0, 1.0 / 8.0, 1.0 / 16.0),
              zb * series(zb, 1.0 / 2.0, 1.0 / 8.0, 1.0 / 16.0), less, series(less, 1.0, 1.0, 1.0, 1.0));
  }
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

/// `by_momentum` times the size of the momentum is the angle. Series for short rotations.
About about(double by_momentum, double squared_momentum) {
  const double x = by_momentum * by_momentum * squared_momentum;  // square of the angle
  return {series(x, 1.0, -1.0 / 2.0, 1.0 / 24.0, -1.0 / 720.0, 1.0 / 40320.0, -1.0 / 3628800.0),
          by_momentum * series(x, 1.0, -1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0, 1.0 / 362880.0)};
}

/// With n the momentum's displacement, e = n^2 / (4 L^2) and k = 2 E / L^2 - J, the whole angle is
///
///     (2 E t + integral of n . k n / (4 (1 - e)) dt) / L,
///
/// whose integral is small. Simpson's rule with the slopes at the ends is exact for it, to rounding.
///
/// It follows from free_rotation()'s integrand and the conserved quantities. |m + n| = |m| gives m.n = -n^2 /
/// 2, so L^2 + m.m(t) = 2 L^2 (1 - e). Equal energy gives m.J n = -n.J n / 2, so the numerator is 2 (2 E) -
/// n.J n / 2. Subtracting 2 E / L^2 leaves n.k n / (4 L^2 (1 - e)). With f this integrand, f and f' are 0 at
/// the start, and
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

/// Rotates the orientation by a unit quaternion, as turn_on() above. A short rotation's cosine is near 1, so
/// no other case exists.
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

/// free_rotation() for short rotations, without roots and with few divisions. It multiplies the shortest
/// rotation of the momentum by the rotation about it. The product has the norm sqrt(1 - e) if the scalar part
/// of the first is 1 - e and the vector of the second is along m + n / 2.
///
///     (2 L^2 (1 - e), n x m)  then  (cos, sin m / L),  over 2 L^2:
///     scalar  cos (1 - e),     vector  cos n x m / 2 L^2 + sin / L (m + n / 2)
///
/// as m x (n x m) = n L^2 - m (m.n) = n L^2 + m n^2 / 2. cos and sin are those of half the angle; `sine`
/// includes 1 / L, so no root of L^2 is needed.
void turn_shortly(const Body& body, const Vector3& angular_momentum, double step, Quaternion& q) {
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

/// Largest rotation of an operator in a step that three terms give to rounding [rad]: 0.05 rad/s at 1 ms.
constexpr double kSlowAngle = 5e-5;

bool is_slow(const Body& body, const Vector3& angular_momentum, double step) {
  const double rate = body.inverse_moments.maxCoeff() * step;
  return rate * rate * angular_momentum.squaredNorm() <= kSlowAngle * kSlowAngle;
}

/// free_rotation() for slow rotations. With w the angular velocity, and primes for rates in the body, the
/// body rotates by the vector (Magnus 1954)
///
///     h w + h^2 w' / 2 + h^3 (w'' + w x w' / 2) / 6,     a term of h^4 being below rounding
void turn_slowly(const Body& body, const Vector3& angular_momentum, double step, Quaternion& q) {
  const PrincipalAxes axes(body);
  const Triple m = axes.along(to_body(q, triple(angular_momentum))), moments = triple(body.inverse_moments);
  const Triple w = each(moments, m), m1 = m.cross(w), w1 = each(moments, m1),
               w2 = each(moments, m1.cross(w) + m.cross(w1));
  const Triple by = step * (w + 0.5 * step * (w1 + step / 3.0 * (w2 + 0.5 * w.cross(w1))));
  const About turn = about(0.5, by.dot(by));
  turn_on(turn.cosine, turn.sine * axes.to_body(by), q);
}

// x += h p / m + h^2 g / 2 with p at the start of the step, then p += m h g. If contacts were solved
// implicitly, the caller passes g = 0: p is then that of the end, and x += h v(h) is backward Euler's.
void fly_on(double mass, const Vector3& gravity, double step, BodyState& state) {
  const Vector3 velocity = state.linear_momentum / mass;
  state.pose.position += step * velocity + (0.5 * step * step) * gravity;
  state.linear_momentum += (mass * step) * gravity;
}

}  // namespace

// Exact for any step: a parabola, and Euler's equations in closed form. The angular momentum in world axes is
// unchanged; only the axes rotate.
void free_flight(const Body& body, const Vector3& gravity, double step, BodyState& state) {
  if (!body.flies) return;
  fly_on(body.mass, gravity, step, state);
  // A person floats slowly. Objects keep to one algorithm.
  if (body.is_operator && is_slow(body, state.angular_momentum, step))
    return turn_slowly(body, state.angular_momentum, step, state.pose.orientation);
  const Turn turn = turn_of(quickness(body), state.angular_momentum, step);
  if (turn == Turn::long_one) turn_far(body, state.angular_momentum, step, state.pose.orientation);
  if (turn == Turn::short_one) turn_shortly(body, state.angular_momentum, step, state.pose.orientation);
}

//     quickness |L|^2 h^2 <= 1,
//     quickness = max((1/I_min - 1/I_max) / kShortPath, (1/I_min) / kShortAngle)^2
//
// So the momentum rotates by at most kShortPath in the body, and the body by at most kShortAngle. Squares are
// compared, as a root of |L|^2 would cost more than all else. The form !(x > y) is also true for NaN.
Turn turn_of(double quickness, const Vector3& angular_momentum, double step) {
  const double squared = angular_momentum.squaredNorm();
  if (!(squared > kMinSquaredMomentum)) return Turn::none;
  return quickness * squared * (step * step) <= 1.0 ? Turn::short_one : Turn::long_one;
}

double quickness(const Body& body) {
  const double limit = std::max(spread(body) / kShortPath, body.inverse_moments.maxCoeff() / kShortAngle);
  return limit * limit;
}

// Divides the step into parts in which the momentum rotates by at most kFreeTurn in the body: |dL/dt| <= |L|
// (1/I_min - 1/I_max) |L|. A ball's momentum does not rotate, so one part suffices at any spin.
void turn_far(const Body& body, const Vector3& angular_momentum, double step, Quaternion& orientation) {
  const double travel = spread(body) * angular_momentum.norm() * step;
  const double enough = std::min(kMaxParts, travel / kFreeTurn);  // in this order never NaN
  const int parts = 1 + static_cast<int>(enough);
  for (int i = 0; i < parts; ++i) {
    const Vector3 momentum = orientation.conjugate() * angular_momentum;
    Quaternion by =
        free_rotation(body.inverse_moments, body.principal_axes.transpose() * momentum, step / parts);
    by.vec() = body.principal_axes * by.vec();
    turn_on(by, orientation);
  }
}

}  // namespace mrhi
