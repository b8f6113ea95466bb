#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "../engine.h"

namespace mrhi::benchmark {

/// Motion of a held object in the hand, after it has settled.
class Displacement {
 public:
  /// `pose` of the object in the hand's frame.
  void add(double t, const Pose& pose) {
    if (times_.empty()) start_ = pose;
    times_.push_back(t);
    places_.push_back(pose.position - start_.position);
    greatest_ = std::max(greatest_, places_.back().norm());
    greatest_turn_ = std::max(greatest_turn_, pose.orientation.angularDistance(start_.orientation));
  }

  double greatest() const { return greatest_; }            ///< [m]
  double greatest_turn() const { return greatest_turn_; }  ///< [rad]
  double last() const { return places_.empty() ? 0.0 : places_.back().norm(); }

  /// Rms of the motion minus its running mean over `window` [s]; [m].
  double jitter(double window) const {
    if (times_.size() < 3) return 0.0;
    const double step = (times_.back() - times_.front()) / static_cast<double>(times_.size() - 1);
    const std::size_t half = std::max<std::size_t>(1, static_cast<std::size_t>(0.5 * window / step));
    if (places_.size() <= 2 * half + 1) return 0.0;
    Vector3 sum = Vector3::Zero();
    for (std::size_t i = 0; i <= 2 * half; ++i) sum += places_[i];
    double squares = 0.0;
    for (std::size_t i = half; i + half < places_.size(); ++i) {
      squares += (places_[i] - sum / static_cast<double>(2 * half + 1)).squaredNorm();
      if (i + half + 1 < places_.size()) sum += places_[i + half + 1] - places_[i - half];
    }
    return std::sqrt(squares / static_cast<double>(places_.size() - 2 * half));
  }

 private:
  Pose start_;
  std::vector<double> times_;
  std::vector<Vector3> places_;
  double greatest_ = 0.0, greatest_turn_ = 0.0;
};

}  // namespace mrhi::benchmark
