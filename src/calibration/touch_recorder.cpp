#include "touch_recorder.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "../text/text.h"

namespace mrhi {
namespace {

constexpr double kStill = 0.003;  // [m]: a resting hand and a tracker's jitter stay well within it
constexpr double kApart = 0.02;   // [m]: further than a finger that rests where it was

constexpr double kNearest = 0.03;  // [m] between two points, so that each is told from the one before

void refuse_near(const TouchedPoint& a, const TouchedPoint& b) {
  const double distance = (a.world - b.world).norm();
  if (distance >= kNearest) return;
  throw std::invalid_argument("points " + a.name + " and " + b.name + " are " + text::number(1e3 * distance) +
                              " mm apart; allowed: at least " + text::number(1e3 * kNearest) + " mm");
}

}  // namespace

TouchRecorder::TouchRecorder(std::vector<TouchedPoint> points, std::size_t samples)
    : points_(std::move(points)), samples_(samples) {
  if (samples < 1) throw std::invalid_argument("samples is 0; allowed: 1 or more");
  for (auto a = points_.begin(); a != points_.end(); ++a)
    for (auto b = a + 1; b != points_.end(); ++b) refuse_near(*a, *b);
}

bool TouchRecorder::add(const Vector3& tip, double radius) {
  if (done()) return false;
  tips_.push_back(tip);
  if (tips_.size() > samples_) tips_.pop_front();
  if (tips_.size() < samples_) return false;
  const Vector3 sum = std::accumulate(tips_.begin(), tips_.end(), Vector3(Vector3::Zero()));
  const Vector3 mean = sum / static_cast<double>(samples_);
  if (!is_still(mean) || !is_new(mean)) return false;
  points_[taken_].device = mean;
  points_[taken_].radius = radius;
  ++taken_;
  tips_.clear();
  return true;
}

void TouchRecorder::lose() {
  tips_.clear();
}

bool TouchRecorder::is_still(const Vector3& mean) const {
  return std::all_of(tips_.begin(), tips_.end(),
                     [&](const Vector3& tip) { return (tip - mean).norm() <= kStill; });
}

bool TouchRecorder::is_new(const Vector3& place) const {
  return std::all_of(points_.begin(), points_.begin() + static_cast<std::ptrdiff_t>(taken_),
                     [&](const TouchedPoint& point) { return (*point.device - place).norm() >= kApart; });
}

}  // namespace mrhi
