#pragma once

#include <array>
#include <deque>
#include <random>

#include "support/grips.h"

namespace mrhi::testing {

constexpr double kNoisyRate = 120.0;  // [1/s]
constexpr double kNoisyFrom = 1.0, kNoisyFor = 10.0, kNoisyAfter = 2.0;
constexpr double kHandNoise = 0.0003, kFingerNoise = 0.00015;  // [m] rms on every axis

/// White noise on each sample of scene (a)'s hand: one shift of the whole hand, one of each finger.
class NoisyPinch {
 public:
  explicit NoisyPinch(unsigned seed, const PinchScene& pinch = {}) : pinch_(pinch), random_(seed) {}

  Hand sample(double t) {
    const double u = t - kNoisyFrom;
    const bool moving = u >= 0.0 && u < kNoisyFor;
    const double ease = smooth(u, 1.0) * (1.0 - smooth(u - kNoisyFor + 1.0, 1.0));
    const Vector3 sway = ease * swing(u, 0.1, 0.5);
    Hand hand = pinch_.hand(t, sway);
    hand.palm.position = sway;
    if (!moving) return hand;
    const Vector3 shift = gaussian(kHandNoise);
    hand.palm.position += shift;
    for (int finger = 0; finger < kFingers; ++finger) {
      const Vector3 both = shift + gaussian(kFingerNoise);
      for (int bone = 0; bone < kBonesPerFinger; ++bone) {
        Capsule& capsule = hand.capsules[static_cast<std::size_t>(capsule_index(finger, bone))];
        capsule.start += both;
        capsule.end += both;
      }
    }
    return hand;
  }
  Scene scene() const { return pinch_.scene(); }

 private:
  Vector3 gaussian(double deviation) {
    const double x = normal_(random_), y = normal_(random_), z = normal_(random_);
    return deviation * Vector3(x, y, z);
  }

  PinchScene pinch_;
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
};

/// rms of what a path has above its mean over a window of 25 ms.
class Jitter {
 public:
  void add(const Vector3& position) {
    window_.push_back(position);
    if (window_.size() > kWindow) window_.pop_front();
    if (window_.size() < kWindow) return;
    Vector3 mean = Vector3::Zero();
    for (const Vector3& p : window_) mean += p / static_cast<double>(kWindow);
    sum_ += (window_[kWindow / 2] - mean).squaredNorm();
    ++count_;
  }
  double rms() const { return std::sqrt(sum_ / count_); }

 private:
  static constexpr std::size_t kWindow = 25;  // steps of 1 ms
  std::deque<Vector3> window_;
  double sum_ = 0.0;
  int count_ = 0;
};

/// The hand's jitter is that of the five fingertips that hold the cube: nothing held by them can be steadier
/// than the fingers are on average.
struct NoisyRide {
  double true_slip = 0.0, displacement = 0.0;  // [m]
  Jitter cube, palm;
  std::array<Jitter, kFingers> tips;

  double fingertips() const {
    double sum = 0.0;
    for (const Jitter& tip : tips) sum += tip.rms() * tip.rms() / kFingers;
    return std::sqrt(sum);
  }
};

/// Where the path of a filtered hand has its palm and its fingertips, at a fraction of the frame.
inline Hand on_path(const HandTrack& track, double fraction) {
  Hand hand = track.current;
  for (std::size_t point = 0; point < kHandPoints; ++point) {
    const Vector3 from = hand_point(track.previous, point);
    const Vector3 chord = hand_point(track.current, point) - from;
    hand_point(hand, point) = from + PathWeights::at(fraction)(chord, track.path.start_bend.points[point],
                                                               track.path.end_bend.points[point]);
  }
  return hand;
}

/// The hand that counts is the filtered one: it is what touches and what is shown.
inline NoisyRide noisy_ride(const NoisyPinch& noisy, const Configuration& configuration) {
  NoisyPinch pinch = noisy;
  Simulation simulation(pinch.scene(), configuration);
  NoisyRide ride;
  Vector3 before = Vector3::Zero();
  const int frames = static_cast<int>((kNoisyFrom + kNoisyFor + kNoisyAfter) * kNoisyRate);
  for (int frame = 0; frame < frames; ++frame) {
    const double t = frame / kNoisyRate;
    simulation.begin({at(t), {pinch.sample(t)}});
    const HandTrack& track = simulation.state().hands[0];
    const int steps = static_cast<int>(std::ceil(1000.0 / kNoisyRate));
    for (int i = 1; simulation.step(); ++i) {
      const Hand now = on_path(track, static_cast<double>(i) / steps);
      const Vector3 hand = now.palm.position;
      const Vector3 cube = simulation.state().bodies[0].pose.position;
      if (t < kNoisyFrom) before = cube - hand;
      if (t < kNoisyFrom || t >= kNoisyFrom + kNoisyFor) continue;
      ride.displacement = std::max(ride.displacement, (cube - hand - before).norm());
      ride.cube.add(cube);
      ride.palm.add(hand);
      for (std::size_t finger = 0; finger < kFingers; ++finger)
        ride.tips[finger].add(
            now.capsules[static_cast<std::size_t>(capsule_index(static_cast<int>(finger), 3))].end);
    }
    simulation.end();
  }
  ride.true_slip = (simulation.state().bodies[0].pose.position - before).norm();
  return ride;
}

}  // namespace mrhi::testing
