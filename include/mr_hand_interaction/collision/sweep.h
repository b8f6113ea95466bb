#pragma once

#include <optional>

#include "mr_hand_interaction/collision/closest_features.h"

namespace mrhi {

/// Closest features of two things at a time, and how fast their distance changes.
struct Separation {
  ClosestFeatures features;
  double rate;  ///< [m/s], < 0 approaches
};

/// First touch of two things in relative motion.
struct FirstTouch {
  double time;               ///< [s]
  ClosestFeatures features;  ///< then; distance about 0
};

/// Finds when the distance first gets down to 0 within `duration` [s], if it does; `separation(time)` gives
/// an optional Separation, nothing where the two are far apart. For convex shapes in relative translation the
/// distance is convex in time, so that Newton's method from the start approaches the first touch from before
/// it.
template <typename SeparationAt>
std::optional<FirstTouch> first_touch(const SeparationAt& separation, double duration) {
  constexpr double kTouch = 1e-6;  // nearer is a touch [m]
  constexpr int kMaxSteps = 30;
  double time = 0.0;
  for (int i = 0; i < kMaxSteps; ++i) {
    const std::optional<Separation> now = separation(time);
    if (!now) return std::nullopt;
    if (now->features.distance <= kTouch) return FirstTouch{time, now->features};
    if (now->rate >= 0.0) return std::nullopt;
    time += now->features.distance / -now->rate;
    if (time > duration) return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace mrhi
