#include <algorithm>
#include <cmath>

#include "hand_filter.h"
#include "noise_estimate.h"

namespace mrhi {
namespace {

constexpr double kFirstSpeed = 0.5;  // rms of a hand that has just appeared [m/s]

/// How much of the difference between sample and prediction goes into position, and into velocity [1/s].
struct Gain {
  double position, velocity;
};

/// The Kalman filter's, for an acceleration that is white from frame to frame (Bar-Shalom, Li & Kirubarajan
/// 2001, 6.3.2).
///
/// State (x, v) on an axis, over the interval T, with the acceleration's deviation a and the sample's r, P =
/// [[position, mixed], [mixed, speed]]:
///     F = [[1, T], [0, 1]],   Q = a^2 [[T^4 / 4, T^3 / 2], [T^3 / 2, T^2]],   P <- F P F^T + Q
///     K = (P_xx, P_xv) / (P_xx + r^2),   P <- (1 - K H) P,   H = (1, 0).
/// All axes and points share P, as they share a and r, so that three numbers are enough for a hand.
/// Multiplied by one factor a and r give the same gains in the end: only their ratio counts. A hand that
/// appears is where its sample says, within r, at a speed of kFirstSpeed or so.
Gain update(double acceleration, double noise, double elapsed, MotionVariance& variance) {
  if (variance.speed == 0.0) variance = {noise * noise, 0.0, kFirstSpeed * kFirstSpeed};
  const double q = acceleration * acceleration * elapsed * elapsed;
  const double position = variance.position + elapsed * (2.0 * variance.mixed + elapsed * variance.speed) +
                          0.25 * q * elapsed * elapsed;
  const double mixed = variance.mixed + elapsed * variance.speed + 0.5 * q * elapsed;
  const double speed = variance.speed + q;
  const double total = position + noise * noise;
  const Gain gain{position / total, mixed / total};
  variance = {(1.0 - gain.position) * position, (1.0 - gain.position) * mixed, speed - gain.velocity * mixed};
  return gain;
}

/// rms speed of the hand without what noise beyond the usual feigns: three axes of the estimate's own error.
/// The rms of an estimate is that of the truth and of its error together: E|v|^2 = v^2 + 3 P_vv. What the
/// usual noise r0 adds stays in; of the rest the share is 1 - r0^2 / r^2.
double true_speed(const FilterMemory& memory, double noise) {
  const double speed = rms_speed(memory.velocity, memory.filtered);
  if (noise <= kUsualNoise) return speed;
  const double beyond = 1.0 - kUsualNoise * kUsualNoise / (noise * noise);
  return std::sqrt(std::max(0.0, speed * speed - 3.0 * beyond * memory.variance.speed));
}

/// exp([turned]x): by |turned| about its direction, in world.
Quaternion rotation(const Vector3& turned) {
  const double angle = turned.norm();
  if (angle == 0.0) return Quaternion::Identity();
  return Quaternion(Eigen::AngleAxisd(angle, turned / angle));
}

/// The same filter for a rotation: predicted = exp(T w) q, innovation = log(q_sample predicted^-1), which is
/// small, so that turns about it add like vectors; all in world, from the left. AngleAxis takes the shorter
/// way round, whichever sign the quaternions have.
void follow_turn(const Gain& gain, double elapsed, const Quaternion& before, Quaternion& orientation,
                 Vector3& turn) {
  const Quaternion predicted = rotation(elapsed * turn) * before;
  const Eigen::AngleAxisd off(orientation * predicted.conjugate());
  const Vector3 innovation = off.angle() * off.axis();
  orientation = (rotation(gain.position * innovation) * predicted).normalized();
  turn += gain.velocity * innovation;
}

/// Prediction x + T v, innovation z - prediction; a point that comes or goes begins at rest where it is seen.
Hand constant_velocity(double elapsed, const FilterConfiguration& filter, FilterMemory& memory) {
  if (!filter.noise) observe_noise(memory.history, memory.noise);
  const double noise = filter.noise.value_or(filter_noise(memory.noise));
  Hand hand = memory.history.samples[0];
  const double speed = true_speed(memory, noise);
  const Gain gain = update(filter.acceleration + filter.agility * speed, noise, elapsed, memory.variance);
  for (std::size_t point = 0; point < kHandPoints; ++point) {
    Vector3& velocity = memory.velocity.points[point];
    if (!has_point(hand, point) || !has_point(memory.filtered, point)) {
      velocity.setZero();
      continue;
    }
    Vector3& position = hand_point(hand, point);
    const Vector3 predicted = hand_point(memory.filtered, point) + elapsed * velocity;
    const Vector3 innovation = position - predicted;
    position = predicted + gain.position * innovation;
    velocity += gain.velocity * innovation;
  }
  follow_turn(gain, elapsed, memory.filtered.palm.orientation, hand.palm.orientation, memory.velocity.turn);
  return hand;
}

}  // namespace

/// Every point goes on as it went, but for accelerations unknown: a Kalman filter of position and velocity,
/// one gain for the whole hand. The acceleration expected grows with the hand's speed.
extern const HandFilter constant_velocity_filter{
    "constant_velocity", 3,
    []() -> std::vector<FilterSetting> {
      using F = FilterConfiguration;
      return {
          {"noise", " [m]", {1e-6, 0.1}, {1e-5, 0.01}, &F::noise, "estimated", "for what the stream shows"},
          {"acceleration", " [m/s^2]", {0.001, 1000}, {0.01, 10}, &F::acceleration},
          {"agility", " [1/s]", {0, 1000}, {0, 30}, &F::agility}};
    },
    [](const FilterConfiguration& filter) { return filter.noise ? 1 : kNoiseSamples; }, constant_velocity};

}  // namespace mrhi
