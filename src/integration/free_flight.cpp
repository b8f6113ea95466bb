#include "free_flight.h"

#include <algorithm>
#include <cmath>

#include "free_rotation.h"

namespace mrhi {
namespace {

/// More parts than this no step is divided into: spins that need it are beyond what can be seen.
constexpr double kMostParts = 1000.0;
/// Square of an angular momentum that turns nothing in a year [kg^2 m^4/s^2].
constexpr double kNoSpin = 1e-200;

/// Turns `orientation` on by `by`, which need not be unit. What is added is rounded but once: were the
/// product divided by its norm, slow turns would be rounded the same way in every step and drift.
///
///     q <- q + q (b - 1),      b - 1 = ((1 + s) cos - 1, (1 + s) sin),      s = (1 - |q|^2) / 2
///     cos - 1 = -sin^2 / (1 + cos)           where cos > 0: what is small is made small
///
/// s takes back what |q| is off by in the first order, so q is never divided by its norm.
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

// 1/I_min - 1/I_max: |w x L| is at most that times |L|^2, and 0 of a ball.
double spread(const Body& body) {
  return body.inverse_moments.maxCoeff() - body.inverse_moments.minCoeff();
}

Triple<double> triple(const Vector3& v) {
  return {v.x(), v.y(), v.z()};
}

}  // namespace

// Exact for any step: a parabola, and Euler's equations in their closed form. The angular momentum in world
// axes stays as it is to the bit; only the axes turn under it.
void free_flight(const Body& body, const Vector3& gravity, double step, BodyState& state) {
  if (!body.flies) return;
  fly_on(body.mass, gravity, step, state);
  const Turn turn = turn_of(quickness(body), state.angular_momentum, step);
  if (turn == Turn::long_one) turn_far(body, state.angular_momentum, step, state.pose.orientation);
  if (turn != Turn::short_one) return;
  Turning<double> turning = turning_of(state, step);
  turn_shortly(spinner_of(body), turning);
  state.pose.orientation = Quaternion(turning.w, turning.x, turning.y, turning.z);
}

// x += h p / m + h^2 g / 2 with the p of the step's start, then p += m h g. Where contacts have been solved
// implicitly the caller gives g = 0: p is the end's already, and x += h v(h) is backward Euler's.
void fly_on(double mass, const Vector3& gravity, double step, BodyState& state) {
  const Vector3 velocity = state.linear_momentum / mass;
  state.pose.position += step * velocity + (0.5 * step * step) * gravity;
  state.linear_momentum += (mass * step) * gravity;
}

//     quickness |L|^2 h^2 <= 1,   quickness = max((1/I_min - 1/I_max) / kShortWay, (1/I_min) / kShortAngle)^2
//
// which is that the momentum goes by no more than kShortWay in the body and the body turns by no more than
// kShortAngle, in squares, since a root of |L|^2 would cost more than the rest. The form !(x > y) is also
// true of what is not a number.
Turn turn_of(double quickness, const Vector3& angular_momentum, double step) {
  const double squared = angular_momentum.squaredNorm();
  if (!(squared > kNoSpin)) return Turn::none;
  return quickness * squared * (step * step) <= 1.0 ? Turn::short_one : Turn::long_one;
}

double quickness(const Body& body) {
  const double most = std::max(spread(body) / kShortWay, body.inverse_moments.maxCoeff() / kShortAngle);
  return most * most;
}

Spinner<double> spinner_of(const Body& body) {
  const auto axis = [&body](int i) { return triple(body.principal_axes.col(i)); };
  const Vector3& moments = body.inverse_moments;
  return {{axis(0), axis(1), axis(2)}, {moments[0], moments[1], moments[2]}};
}

Turning<double> turning_of(const BodyState& state, double step) {
  const Quaternion& q = state.pose.orientation;
  return {q.w(), q.x(), q.y(), q.z(), triple(state.angular_momentum), step};
}

// In parts in which the momentum turns by no more than kFreeTurn in the body: |dL/dt| <= |L| (1/I_min -
// 1/I_max) |L|. A ball's, whose moments are equal, does not turn, and takes one part at any spin.
void turn_far(const Body& body, const Vector3& angular_momentum, double step, Quaternion& orientation) {
  const double way = spread(body) * angular_momentum.norm() * step;
  const double enough = std::min(kMostParts, way / kFreeTurn);  // in this order a number even if way is none
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
