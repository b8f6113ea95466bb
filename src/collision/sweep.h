#pragma once

#include <optional>

namespace mrhi {

/// Distance of two shapes at a time, and its rate.
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
///
/// The distance's rate is n.(v_a - v_b) of the two nearest points: that these wander does not count, as each
/// is nearest (the envelope theorem). Traps: bodies that turn make the distance concave at times, so that a
/// step may end beyond the touch, which then counts with what it overlaps; and what parts now is given up,
/// also where a turn would bring another corner in before the step ends. What only grazes may use up all 30
/// steps, and is no touch then.
template <typename Features, typename SeparationAt>
std::optional<FirstTouch<Features>> first_touch(const SeparationAt& separation, double duration) {
  constexpr double kMaxTouchGap = 1e-6;  // [m]
  constexpr int kMaxSteps = 30;
  double time = 0.0;
  for (int i = 0; i < kMaxSteps; ++i) {
    const std::optional<Separation<Features>> now = separation(time);
    if (!now) return std::nullopt;
    if (now->distance <= kMaxTouchGap) return FirstTouch<Features>{time, now->features};
    if (now->rate >= 0.0) return std::nullopt;
    // The tangent's zero: t + d / -d'. Where d is convex, the tangent is below it, so that this is never
    // late.
    time += now->distance / -now->rate;
    if (time > duration) return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace mrhi
