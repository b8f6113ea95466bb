#include <algorithm>
#include <array>
#include <cmath>

#include "../math/rotation.h"
#include "hand_filter.h"

namespace mrhi {

// The third difference of a joint's path is zero for a parabola. Successive third differences are alike for
// motion and have opposite signs for independent noise. Their product is therefore positive for motion and
// negative for noise, for which its mean is known.

namespace {

constexpr std::size_t kPoints = 4;  // samples of a third difference
using Weights = std::array<double, kPoints>;

/// Smallest overlap of two differences that makes a sample usable; 0.75 at even intervals.
constexpr double kMinOverlap = 0.3;
/// For white noise: the median of many joints' products is 1/1.28 of their mean, over 3 axes. The lower
/// quartile of 16 successive variances is 0.825 of their mean.
constexpr double kMedianProduct = 2.34, kLowerQuartile = 0.825;
/// Smallest number of variances from which noise is estimated.
constexpr int kMinVariances = 5;

/// Weights of a third difference of samples at uneven intervals, normalised to unit length. The first weight
/// is the newest sample's.
///
///     w_i = 1 / prod_{j != i} (t_i - t_j),   sum w_i x(t_i) = 0 for every parabola x
/// is Newton's divided difference. At even intervals that is (1, -3, 3, -1) / sqrt(20). Unit length gives
/// white noise the variance sigma^2 in it for all intervals.
Weights third_difference(const SampleHistory& history, std::size_t newest) {
  std::array<double, kPoints> times{};
  for (std::size_t i = 1; i < kPoints; ++i) times[i] = times[i - 1] - history.elapsed[newest + i - 1];
  Weights weights{};
  double squares = 0.0;
  for (std::size_t i = 0; i < kPoints; ++i) {
    weights[i] = 1.0;
    for (std::size_t j = 0; j < kPoints; ++j)
      if (j != i) weights[i] /= times[i] - times[j];
    squares += weights[i] * weights[i];
  }
  for (double& weight : weights) weight /= std::sqrt(squares);
  return weights;
}

/// Third difference at the bone's end. Ends are all joints except the roots.
Vector3 difference_of(const SampleHistory& history, std::size_t newest, std::size_t capsule,
                      const Weights& weights) {
  Vector3 sum = Vector3::Zero();
  for (std::size_t i = 0; i < kPoints; ++i)
    sum += weights[i] * history.samples[newest + i].capsules[capsule].end;
  return sum;
}

bool is_in_all(const SampleHistory& history, std::size_t capsule) {
  return std::all_of(history.samples.begin(), history.samples.begin() + kNoiseSamples,
                     [capsule](const Hand& hand) { return hand.capsules[capsule].radius > 0.0; });
}

/// Median over the joints of the negative product of the last two differences, positive for noise. Nothing
/// without joints. Over three axes the mean of d_now.d_before is -3 overlap sigma^2. A median, because a
/// single leaping joint would dominate a mean.
std::optional<double> median_product(const SampleHistory& history, const Weights& now,
                                     const Weights& before) {
  std::array<double, kPhalanges> products{};
  std::ptrdiff_t count = 0;
  for (std::size_t c = 0; c < kPhalanges; ++c) {
    if (!is_in_all(history, c)) continue;
    products[count++] = -difference_of(history, 0, c, now).dot(difference_of(history, 1, c, before));
  }
  if (count == 0) return std::nullopt;
  const auto middle = products.begin() + count / 2;
  std::nth_element(products.begin(), middle, products.begin() + count);
  return *middle;
}

/// Expected negative product for noise of variance 1 on an axis. The differences share three samples:
/// -sum w_now(i) w_before(i), 15 / 20 at even intervals.
double overlap(const Weights& now, const Weights& before) {
  double sum = 0.0;
  for (std::size_t i = 1; i < kPoints; ++i) sum -= now[i] * before[i - 1];
  return sum;
}

/// Adds a variance. Motion counts as zero noise: leaving it out would bias the estimate.
void add(double variance, SeenNoise& noise) {
  noise.size = std::min(noise.size + 1, kNoiseWindow);
  std::copy_backward(noise.variances.begin(), noise.variances.begin() + noise.size - 1,
                     noise.variances.begin() + noise.size);
  noise.variances[0] = variance;
}

/// Lower quartile of the variances: a jerk is large in a few samples, noise in all.
double low_variance(const SeenNoise& noise) {
  if (noise.size < kMinVariances) return 0.0;
  std::array<double, kNoiseWindow> sorted = noise.variances;
  const auto low = sorted.begin() + noise.size / 4;
  std::nth_element(sorted.begin(), low, sorted.begin() + noise.size);
  return *low / kLowerQuartile;
}

/// Rms speed of a hand that has just appeared [m/s].
constexpr double kFirstSpeed = 0.5;

/// Lag behind a hand that sets off, which the filter does not exceed once it has seen it [m].
constexpr double kMaxLag = 0.002;

/// Gains of the innovation on position, and on velocity [1/s].
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
/// Only the ratio of a to r determines the gains in the end. A hand that appears is within r of its sample,
/// at an rms speed of kFirstSpeed.
///
/// A hand that sets off leaves the prediction behind by a lag d that P knows nothing of. Earlier samples fade
/// then (Xia, Rao, Ying & Shen 1994):
///     P <- P max(1, min(d^4 / r^2, r^2 d / kMaxLag) / P_xx)
/// so that K_x is at least the smaller of d / (d + kMaxLag), which leaves less than kMaxLag of the lag, and
/// d^4 / (d^4 + r^4), which disregards what is below the noise.
Gain update(double acceleration, double noise, double lag, double elapsed, MotionVariance& variance) {
  if (variance.speed == 0.0) variance = {noise * noise, 0.0, kFirstSpeed * kFirstSpeed};
  const double q = acceleration * acceleration * elapsed * elapsed;
  double position = variance.position + elapsed * (2.0 * variance.mixed + elapsed * variance.speed) +
                    0.25 * q * elapsed * elapsed;
  const double known = lag * std::min(lag * lag * lag / (noise * noise), noise * noise / kMaxLag);
  const double fading = std::max(1.0, known / position);
  position *= fading;
  const double mixed = fading * (variance.mixed + elapsed * variance.speed + 0.5 * q * elapsed);
  const double speed = fading * (variance.speed + q);
  const double total = position + noise * noise;
  const Gain gain{position / total, mixed / total};
  variance = {(1.0 - gain.position) * position, (1.0 - gain.position) * mixed, speed - gain.velocity * mixed};
  return gain;
}

/// Rms speed of the hand, corrected for noise beyond the usual: E|v|^2 = v^2 + 3 P_vv for the estimate over
/// three axes. The part due to the usual noise r0 is kept; the rest is the fraction 1 - r0^2 / r^2.
double true_speed(const FilterMemory& memory, double noise) {
  const double speed = rms_speed(memory.velocity, memory.filtered);
  if (noise <= kUsualNoise) return speed;
  const double beyond = 1.0 - kUsualNoise * kUsualNoise / (noise * noise);
  return std::sqrt(std::max(0.0, speed * speed - 3.0 * beyond * memory.variance.speed));
}

/// The same filter for a rotation: predicted = exp(T w) q, innovation = log(q_sample predicted^-1), which is
/// small, so that rotations add like vectors; all in world, from the left. rotation_vector() takes the
/// shorter arc for either sign of the quaternions.
void follow_turn(const Gain& gain, double elapsed, const Quaternion& before, Quaternion& orientation,
                 Vector3& turn) {
  const Quaternion predicted = rotation_by(elapsed * turn) * before;
  const Vector3 innovation = rotation_vector(orientation * predicted.conjugate());
  orientation = (rotation_by(gain.position * innovation) * predicted).normalized();
  turn += gain.velocity * innovation;
}

/// Estimates the noise. Where it was underestimated so far, so was the filter's own variance: without the
/// correction a hand that appears would keep the velocity that its first samples' noise feigned.
///
///     P <- P (r / r_before)^2   for r > r_before, as P of a given a / r is proportional to r^2
void observe_noise(FilterMemory& memory) {
  const double before = filter_noise(memory.noise);
  mrhi::observe_noise(memory.history, memory.noise);
  const double ratio = std::max(1.0, filter_noise(memory.noise) / before), factor = ratio * ratio;
  MotionVariance& variance = memory.variance;
  variance = {factor * variance.position, factor * variance.mixed, factor * variance.speed};
}

/// Distance by which the prediction lags behind the hand [m]; 0 for a hand that the filter follows.
///
///     d^2 = max(0, <z - x>.<z' - x'>)
/// with < > the mean over the joints (the ends of bones), and z' - x' what the last frame left of its
/// innovation. A hand that sets off leaves all joints behind in one direction, frame after frame. The mean
/// product of noise is zero if it differs from frame to frame or from joint to joint.
double lag_of(const FilterMemory& memory, double elapsed) {
  const Hand &now = memory.history.samples[0], &before = memory.history.samples[1], &last = memory.filtered;
  Vector3 innovation = Vector3::Zero(), left = Vector3::Zero();
  int joints = 0;
  for (std::size_t point = 3; point < 2 + 2 * kPhalanges; point += 2) {
    if (!has_point(now, point) || !has_point(last, point)) continue;
    const Vector3& at = hand_point(last, point);
    innovation += hand_point(now, point) - at - elapsed * memory.velocity.points[point];
    left += hand_point(before, point) - at;
    ++joints;
  }
  return joints > 0 ? std::sqrt(std::max(0.0, innovation.dot(left))) / joints : 0.0;
}

/// Prediction x + T v, innovation z - prediction; a point that appears begins at rest where it is seen.
Hand constant_velocity(double elapsed, const FilterConfiguration& filter, FilterMemory& memory) {
  if (!filter.noise) observe_noise(memory);
  const double noise = filter.noise.value_or(filter_noise(memory.noise));
  Hand hand = memory.history.samples[0];
  const double speed = true_speed(memory, noise);
  const Gain gain = update(filter.acceleration + filter.agility * speed, noise, lag_of(memory, elapsed),
                           elapsed, memory.variance);
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

/// sigma^2 = product / (2.34 overlap), with 2.34 = 3 axes / 1.28. Skips samples at very uneven intervals,
/// whose differences hardly overlap: the division would amplify rounding.
void observe_noise(const SampleHistory& history, SeenNoise& noise) {
  if (history.size < kNoiseSamples) return;
  const Weights now = third_difference(history, 0), before = third_difference(history, 1);
  const double expected = overlap(now, before);
  if (expected < kMinOverlap) return;
  const std::optional<double> product = median_product(history, now, before);
  if (!product) return;
  add(std::max(0.0, *product) / (kMedianProduct * expected), noise);
  noise.variance = low_variance(noise);
}

// Up to 1 mm a grasp holds with the usual setting, and jerks of a fast hand look like such noise. A larger
// weight on the excess would delay a closing hand by more than noise disturbs a grasp.
double filter_noise(const SeenNoise& seen) {
  constexpr double kIgnoredNoise = 0.001;  // [m]
  const double beyond = std::max(0.0, seen.variance - kIgnoredNoise * kIgnoredNoise);
  return std::sqrt(kUsualNoise * kUsualNoise + beyond);
}

/// Kalman filter of position and velocity with unknown accelerations and one gain for the whole hand. The
/// expected acceleration grows with the hand's speed.
extern const HandFilter constant_velocity_filter{
    "constant_velocity", 3,
    []() -> std::vector<FilterSetting> {
      using F = FilterConfiguration;
      return {
          {"noise", " [m]", {1e-6, 0.1}, {1e-5, 0.01}, &F::noise, "estimated", "for what the stream shows"},
          {"acceleration", " [m/s^2]", {0.001, 1000}, {0.01, 10}, &F::acceleration},
          {"agility", " [1/s]", {0, 1000}, {0, 30}, &F::agility}};
    },
    [](const FilterConfiguration& filter) { return filter.noise ? 2 : kNoiseSamples; }, constant_velocity};

}  // namespace mrhi
