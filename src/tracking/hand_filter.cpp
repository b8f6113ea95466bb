#include "hand_filter.h"

#include <algorithm>
#include <cmath>

#include "filters.h"

namespace mrhi {
namespace {

int samples_needed(const FilterConfiguration& filter) {
  switch (filter.type) {
    case FilterKind::window:
      return std::min(filter.window, kMaxFilterWindow);
    case FilterKind::one_euro:
      return 2;
    case FilterKind::constant_velocity:
      return filter.noise ? 1 : kNoiseSamples;
    case FilterKind::none:
      break;
  }
  return 1;
}

Hand pass(double elapsed, const FilterConfiguration& filter, FilterMemory& memory) {
  switch (filter.type) {
    case FilterKind::window:
      return window_mean(filter, memory);
    case FilterKind::one_euro:
      return one_euro(elapsed, filter, memory);
    case FilterKind::constant_velocity:
      return constant_velocity(elapsed, filter, memory);
    case FilterKind::none:
      break;
  }
  return memory.history.samples[0];
}

}  // namespace

Hand filtered(const Hand& sample, double elapsed, const FilterConfiguration& filter, FilterMemory& memory) {
  if (memory.empty()) {
    memory.restart(sample);
    return sample;
  }
  memory.history.push(sample, elapsed, samples_needed(filter));
  memory.filtered = pass(elapsed, filter, memory);
  return memory.filtered;
}

double rms_speed(const HandVelocity& velocity, const Hand& hand) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t point = 2; point < kHandPoints; ++point) {
    if (!has_point(hand, point)) continue;
    sum += velocity.points[point].squaredNorm();
    ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : 0.0;
}

}  // namespace mrhi
