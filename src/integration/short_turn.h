#pragma once

#include "../math/lanes.h"

namespace mrhi {

/// A body's principal axes, in its own; and the inverse moments of inertia along them, J [1/(kg m^2)], the
/// second between the others.
template <typename Real>
struct Spinner {
  Triple<Real> axes[3];
  Real moments[3];
};

/// A body that turns: its orientation, its angular momentum in world axes, and for how long.
template <typename Real>
struct Turning {
  Real w, x, y, z;
  Triple<Real> momentum;
  Real seconds;
};

/// The momentum turns in the body by at most this in a short turn [rad]: series end below rounding.
constexpr double kShortWay = 0.025;
/// And the body turns by at most this [rad].
constexpr double kShortAngle = 0.25;

// Its copies for other registers are not to be mixed up (lanes.h).
namespace {

template <typename Real>
Real series(const Real&, double last) {
  return constant<Real>(last);
}
/// first + x (second + x (third + ...)).
template <typename Real, typename... Others>
Real series(const Real& x, double first, Others... others) {
  return constant<Real>(first) + x * series(x, others...);
}

/// Euler's equations from the principal momentum m on, as in free_rotation.h.
/// Series as in elliptic(), without halving: a short turn's S needs none.
template <typename Real>
class Way {
 public:
  Way(const Triple<Real>& m, const Real (&moments)[3])
      : m_(m),
        j_{moments[2] - moments[1], moments[0] - moments[2], moments[1] - moments[0]},
        slope_(slope(m)),
        both_(j_.x * j_.z * (m.y * m.y)),
        a_(both_ - j_.x * j_.y * (m.z * m.z)),
        b_(both_ - j_.y * j_.z * (m.x * m.x)) {
    const Real sum = a_ + b_, product = a_ * b_, squared = sum * sum;
    s3_ = constant<Real>(-1.0 / 6.0) * sum;
    s5_ = constant<Real>(1.0 / 120.0) * squared + constant<Real>(12.0 / 120.0) * product;
    s7_ = sum * (constant<Real>(-1.0 / 5040.0) * squared - constant<Real>(132.0 / 5040.0) * product);
    s9_ =
        constant<Real>(1.0 / 362880.0) * (squared * squared) +
        product * (constant<Real>(1224.0 / 362880.0) * squared + constant<Real>(3024.0 / 362880.0) * product);
  }

  /// By how much the momentum differs from m after the time t.
  Triple<Real> after(const Real& t) const {
    const Real one = constant<Real>(1.0), t2 = t * t;
    const Real s = t + t * (t2 * (s3_ + t2 * (s5_ + t2 * (s7_ + t2 * s9_)))), q = s * s;
    const Real za = a_ * q, zb = b_ * q, less = both_ * q;
    return at(s, za * series(za, 1.0 / 2.0, 1.0 / 8.0, 1.0 / 16.0, 5.0 / 128.0, 7.0 / 256.0),
              zb * series(zb, 1.0 / 2.0, 1.0 / 8.0, 1.0 / 16.0, 5.0 / 128.0, 7.0 / 256.0), less,
              one / (one - less));
  }
  /// Where 1e-12 of it is enough, and t half a short turn.
  Triple<Real> nearly_after(const Real& t) const {
    const Real t2 = t * t, s = t + t * (t2 * (s3_ + t2 * (s5_ + t2 * s7_))), q = s * s;
    const Real za = a_ * q, zb = b_ * q, less = both_ * q;
    return at(s, za * series(za, 1.0 / 2.0, 1.0 / 8.0, 1.0 / 16.0),
              zb * series(zb, 1.0 / 2.0, 1.0 / 8.0, 1.0 / 16.0), less, series(less, 1.0, 1.0, 1.0, 1.0));
  }
  /// Rate at which a principal momentum changes.
  Triple<Real> slope(const Triple<Real>& m) const {
    return {j_.x * (m.y * m.z), j_.y * (m.x * m.z), j_.z * (m.x * m.y)};
  }

 private:
  /// With 1 - c, 1 - d, 1 - D and 1 / D. Whatever the error of `s`, it is on the momentum's way: energy
  /// holds.
  Triple<Real> at(const Real& s, const Real& c_less, const Real& d_less, const Real& less,
                  const Real& scale) const {
    const Real one = constant<Real>(1.0);
    return {scale * (m_.x * (less - c_less) + slope_.x * s * (one - d_less)),
            scale * (m_.y * (less - c_less - d_less + c_less * d_less) + slope_.y * s),
            scale * (m_.z * (less - d_less) + slope_.z * s * (one - c_less))};
  }

  Triple<Real> m_, j_, slope_;
  Real both_, a_, b_, s3_, s5_, s7_, s9_;
};

template <typename Real>
Triple<Real> each(const Triple<Real>& a, const Triple<Real>& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}

/// A turn about the momentum by twice an angle: its cosine, and its sine by the size of the momentum.
template <typename Real>
struct About {
  Real cosine, sine;
};

/// With n the way of m, e = n^2 / (4 L^2) and k = 2 E / L^2 - J, the whole angle is
///
///     (2 E t + integral of n . k n / (4 (1 - e)) dt) / L,
///
/// of which the integral is small. Simpson's rule with the slopes at the ends is exact for it, to rounding.
/// It comes of free_rotation.h's integrand by what the motion keeps. |m + n| = |m| makes m.n = -n^2 / 2, so
/// L^2 + m.m(t) = 2 L^2 (1 - e); the same energy makes m.J n = -n.J n / 2, so what is above is 2 (2 E) -
/// n.J n / 2; and 2 E / L^2 taken off leaves n.k n / (4 L^2 (1 - e)). With f that integrand, f and f' are 0
/// at the start, and
///
///     integral of f = t / 30 (16 f(t/2) + 7 f(t)) - t^2 / 60 f'(t)
template <typename Real>
About<Real> about(const Way<Real>& way, const Triple<Real>& m, const Triple<Real>& n,
                  const Real (&moments)[3], const Real& over, const Real& t) {
  const Real half = constant<Real>(0.5), over4 = constant<Real>(0.25) * over;
  const Triple<Real> rate{moments[0] * m.x, moments[1] * m.y, moments[2] * m.z};
  const Real twice_energy = rate.dot(m), mean = twice_energy * over;
  const Triple<Real> k{mean - moments[0], mean - moments[1], mean - moments[2]};
  const Triple<Real> middle = way.nearly_after(half * t);
  const Real at_middle = each(k, middle).dot(middle) * series(over4 * middle.dot(middle), 1.0, 1.0, 1.0, 1.0);
  const Triple<Real> kn = each(k, n), slope = way.slope(m + n);
  const Real grown = series(over4 * n.dot(n), 1.0, 1.0, 1.0, 1.0), at_end = kn.dot(n) * grown;
  const Real half_slope = grown * (kn.dot(slope) + at_end * over4 * n.dot(slope));
  const Real integral =
      t * (constant<Real>(16.0 / 120.0) * at_middle + constant<Real>(7.0 / 120.0) * at_end) -
      t * t * (constant<Real>(2.0 / 240.0) * half_slope);

  const Real turned = half * (t * twice_energy + integral), by_momentum = turned * over;
  const Real x = turned * by_momentum;  // the angle's square
  return {series(x, 1.0, -1.0 / 2.0, 1.0 / 24.0, -1.0 / 720.0, 1.0 / 40320.0, -1.0 / 3628800.0),
          by_momentum * series(x, 1.0, -1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0, 1.0 / 362880.0)};
}

/// Turns the orientation on by a unit quaternion. What is added is rounded but once (free_flight.cpp).
///
///     q <- q + q ((1 + s) cos - 1, (1 + s) sin),     s = (1 - |q|^2) / 2,     cos - 1 = -sin^2 / (1 + cos)
///
/// A short turn's cosine is near 1, so that there is no other case.
template <typename Real>
void turn_on(const Real& cosine, const Triple<Real>& sine, Turning<Real>& state) {
  const Real one = constant<Real>(1.0), w = state.w;
  const Triple<Real> u{state.x, state.y, state.z};
  const Real stretched = constant<Real>(0.5) * (one - (w * w + u.dot(u)));
  const Real w_more = stretched * cosine - sine.dot(sine) / (one + cosine);
  const Triple<Real> vector = (one + stretched) * sine;
  const Triple<Real> more = w * vector + w_more * u + u.cross(vector);
  state.w = w + (w_more * w - u.dot(vector));
  state.x = u.x + more.x, state.y = u.y + more.y, state.z = u.z + more.z;
}

/// What free_rotation.h has, for short turns: without roots and with few divisions. The momentum's shortest
/// way and the turn about it make a quaternion of norm sqrt(1 - e) if the scalar part of the one is 1 - e and
/// the vector of the other along m + n / 2.
///
///     (2 L^2 (1 - e), n x m)  then  (cos, sin m / L),  over 2 L^2:
///     scalar  cos (1 - e),     vector  cos n x m / 2 L^2 + sin / L (m + n / 2)
///
/// as m x (n x m) = n L^2 - m (m.n) = n L^2 + m n^2 / 2. cos and sin are those of half the angle; `sine`
/// has the 1 / L in it, so that no root of L^2 is needed.
template <typename Real>
void turn_shortly(const Spinner<Real>& body, Turning<Real>& state) {
  const Real half = constant<Real>(0.5);
  const Triple<Real> u{state.x, state.y, state.z}, across = state.momentum.cross(u), twice = across + across;
  const Triple<Real> local = state.momentum + state.w * twice + twice.cross(u);
  const Triple<Real> m{body.axes[0].dot(local), body.axes[1].dot(local), body.axes[2].dot(local)};
  const Real over = constant<Real>(1.0) / m.dot(m);
  const Way<Real> way(m, body.moments);
  const Triple<Real> n = way.after(state.seconds);
  const About<Real> turn = about(way, m, n, body.moments, over, state.seconds);

  const Real e = constant<Real>(0.25) * over * n.dot(n);
  const Real root_over = series(e, 1.0, 1.0 / 2.0, 3.0 / 8.0, 5.0 / 16.0, 35.0 / 128.0);
  const Real cosine = turn.cosine * root_over, sine = turn.sine * root_over;
  const Triple<Real> v = half * cosine * over * n.cross(m) + sine * (m + half * n);
  turn_on(cosine - cosine * e, v.x * body.axes[0] + v.y * body.axes[1] + v.z * body.axes[2], state);
}

}  // namespace
}  // namespace mrhi
