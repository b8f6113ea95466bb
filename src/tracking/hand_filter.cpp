#include "hand_filter.h"

#include <algorithm>
#include <cmath>

#include "../text/text.h"
#include "hand_filter_list.h"

namespace mrhi {
namespace {

template <typename AnyHand>
auto& point_of(AnyHand& hand, std::size_t point) {
  if (point == 0) return hand.palm.position;
  if (point == 1) return hand.wrist;
  auto& capsule = hand.capsules[(point - 2) / 2];
  return point % 2 == 0 ? capsule.start : capsule.end;
}

}  // namespace

/// elapsed[i] goes with samples[i]: since the sample before it, which is samples[i + 1].
void SampleHistory::push(const Hand& sample, double since, int keep) {
  size = std::min(size + 1, keep);
  std::copy_backward(samples.begin(), samples.begin() + size - 1, samples.begin() + size);
  std::copy_backward(elapsed.begin(), elapsed.begin() + size - 1, elapsed.begin() + size);
  samples[0] = sample;
  elapsed[0] = since;
}

const Vector3& hand_point(const Hand& hand, std::size_t point) {
  return point_of(hand, point);
}
Vector3& hand_point(Hand& hand, std::size_t point) {
  return point_of(hand, point);
}

bool has_point(const Hand& hand, std::size_t point) {
  return point < 2 || hand.capsules[(point - 2) / 2].radius > 0.0;
}

/// Counts the ends of capsules only: palm and wrist always exist, and may be estimates. A joint that two
/// bones share counts twice.
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

/// Keeps the noise estimate, which is the tracker's.
void FilterMemory::restart(const Hand& sample) {
  history.size = 0;
  history.push(sample, 0.0, 1);
  filtered = sample;
  velocity = HandVelocity();
  variance = MotionVariance();
}

#define MRHI_DECLARE(name) extern const HandFilter name;
#define MRHI_ADDRESS(name) &(name),
MRHI_ENTRIES(MRHI_DECLARE)

const std::vector<const HandFilter*>& hand_filters() {
  static const std::vector<const HandFilter*> filters =
      in_their_places<HandFilter>({MRHI_ENTRIES(MRHI_ADDRESS)});
  return filters;
}

const HandFilter& hand_filter(FilterKind kind) {
  return entry_named(hand_filters(), kind.name, "filter");
}

const std::vector<FilterSetting>& filter_settings() {
  static const std::vector<FilterSetting> all = [] {
    std::vector<FilterSetting> settings;
    for (const HandFilter* filter : hand_filters())
      for (const FilterSetting& setting : filter->settings()) settings.push_back(setting);
    return settings;
  }();
  return all;
}

FilterConfiguration filter_of(const Configuration& configuration) {
  FilterConfiguration filter = configuration.filter;
  if (is_literal(configuration)) {
    filter.type = FilterKind::window;
    filter.as_printed = true;
  }
  return filter;
}

Hand filtered(const Hand& sample, double elapsed, const FilterConfiguration& filter, FilterMemory& memory) {
  if (memory.empty()) {
    memory.restart(sample);
    return sample;
  }
  const HandFilter& chosen = hand_filter(filter.type);
  memory.history.push(sample, elapsed, chosen.samples_needed(filter));
  memory.filtered = chosen.pass(elapsed, filter, memory);
  return memory.filtered;
}

}  // namespace mrhi
