#include "free_flight.h"

#include <algorithm>
#include <cmath>

#include "free_rotation.h"

namespace mrhi {
namespace {

/// More parts than this no step is divided into: spins that need it are beyond what can be seen.
constexpr double kMostParts = 1000.0;

/// Turns `orientation` on by `by`, which need not be unit. What is added is rounded but once: were the
/// product divided by its norm, slow turns would be rounded the same way in every step and drift.
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

/// In parts in which the momentum turns by no more than kFreeTurn in the body: |dL/dt| <= |L| (1/I_min -
/// 1/I_max) |L|. A ball's, whose moments are equal, does not turn, and takes one part at any spin.
void turn(const Body& body, const Vector3& angular_momentum, double step, Quaternion& orientation) {
  const Vector3& moments = body.inverse_moments;
  const double spread = moments.maxCoeff() - moments.minCoeff();
  const double way = spread * angular_momentum.norm() * step;
  const double enough = std::min(kMostParts, way / kFreeTurn);  // in this order a number even if way is none
  const int parts = 1 + static_cast<int>(enough);
  for (int i = 0; i < parts; ++i) {
    const Vector3 momentum = orientation.conjugate() * angular_momentum;
    Quaternion by = free_rotation(moments, body.principal_axes.transpose() * momentum, step / parts);
    by.vec() = body.principal_axes * by.vec();
    turn_on(by, orientation);
  }
}

}  // namespace

// Exact for any step: a parabola, and Euler's equations in their closed form. The angular momentum in world
// axes stays as it is to the bit; only the axes turn under it.
void free_flight(const Body& body, const Vector3& gravity, double step, BodyState& state) {
  if (!body.flies) return;
  const Vector3 velocity = state.linear_momentum / body.mass;
  state.pose.position += step * velocity + (0.5 * step * step) * gravity;
  state.linear_momentum += (body.mass * step) * gravity;

  if (state.angular_momentum == Vector3::Zero()) return;
  turn(body, state.angular_momentum, step, state.pose.orientation);
}

}  // namespace mrhi
