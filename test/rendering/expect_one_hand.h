#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "support/in_the_way.h"
#include "support/rendered_check.h"

namespace mrhi::testing {

/// Advances through the frames and looks at every rendered hand.
inline RenderedCheck render_all(const Scene& scene, const std::vector<HandFrame>& frames) {
  Simulation simulation(scene, Configuration());
  RenderedCheck check(simulation.scene());
  for (const HandFrame& frame : frames) {
    if (simulation.advance(frame) == Rejection::none) check.see(simulation);
  }
  return check;
}

/// What docs/pipeline.md promises, but for jumps. Bone lengths and joints hold to rounding by
/// construction.
inline void expect_one_hand_outside(const RenderedCheck& check, const std::string& what) {
  constexpr double kRounding = 1e-9;    // [m]
  constexpr double kAside = 0.005;      // bones are not quite in one plane [rad]
  constexpr double kDeepest = 0.00011;  // the renderer's own bound, and a tenth [m]
  EXPECT_GT(check.frames, 10) << what;
  EXPECT_LE(check.length.value, kRounding) << what << " at " << check.length.time;
  EXPECT_LE(check.apart.value, kRounding) << what << " at " << check.apart.time;
  EXPECT_LE(check.angle.value, kAside) << what << " at " << check.angle.time;
  EXPECT_LE(check.thumb_angle.value, kAside) << what << " at " << check.thumb_angle.time;
  EXPECT_LE(check.depth.value, kDeepest) << what << " at " << check.depth.time;
  EXPECT_EQ(check.late.value, 0.0) << what << " at " << check.late.time;
}

inline void expect_one_hand(const RenderedCheck& check, const std::string& what) {
  constexpr double kJump = 0.002;  // [m]
  expect_one_hand_outside(check, what);
  EXPECT_LE(check.jump.value, kJump) << what << " at " << check.jump.time << ", " << check.jumps << " jumps";
}

}  // namespace mrhi::testing
