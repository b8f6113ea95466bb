#pragma once

#include <cstddef>
#include <deque>
#include <vector>

#include "touched_points.h"

namespace mrhi {

/// Fills in where the device saw a fingertip at each of a list of points, touched one after the other. A
/// point is taken when `samples` positions in a row lie within 3 mm of their mean, which is at least 2 cm
/// from every point taken before.
class TouchRecorder {
 public:
  /// Throws std::invalid_argument if samples is below 1 or two points are within 3 cm of each other.
  TouchRecorder(std::vector<TouchedPoint> points, std::size_t samples);

  /// Takes the tip's centre and radius in the device's frame [m]; whether a point is now taken.
  bool add(const Vector3& tip, double radius);
  /// The tip is out of sight: what was held still so far does not count.
  void lose();

  std::size_t taken() const { return taken_; }
  bool done() const { return taken_ == points_.size(); }
  const std::vector<TouchedPoint>& points() const { return points_; }

 private:
  bool is_still(const Vector3& mean) const;
  bool is_new(const Vector3& place) const;

  std::vector<TouchedPoint> points_;
  std::size_t samples_;
  std::size_t taken_ = 0;
  std::deque<Vector3> tips_;
};

}  // namespace mrhi
