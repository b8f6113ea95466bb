#pragma once

#include <optional>

namespace mrhi {

/// How near two things are at a time, and how fast that changes.
template <typename Features>
struct Separation {
  Features features;
  double distance;  ///< [m]
  double rate;      ///< [m/s], < 0 approaches
};

/// First touch of two things in relative motion.
template <typename Features>
struct FirstTouch {
  double time;        ///< [s]
  Features features;  ///< then; distance about 0
};

/// Finds when the distance first gets down to 0 within `duration` [s], if it does; `separation(time)` gives
/// an optional Separation, nothing where the two are far apart. For convex shapes in relative translation the
/// distance is convex in time, so that Newton's method from the start approaches the first touch from before
/// it.
template <typename Features, typename SeparationAt>
std::optional<FirstTouch<Features>> first_touch(const SeparationAt& separation, double duration) {
  constexpr double kTouch = 1e-6;  // nearer is a touch [m]
  constexpr int kMaxSteps = 30;
  double time = 0.0;
  for (int i = 0; i < kMaxSteps; ++i) {
    const std::optional<Separation<Features>> now = separation(time);
    if (!now) return std::nullopt;
    if (now->distance <= kTouch) return FirstTouch<Features>{time, now->features};
    if (now->rate >= 0.0) return std::nullopt;
    time += now->distance / -now->rate;
    if (time > duration) return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace mrhi
