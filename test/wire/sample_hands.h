#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {

/// A hand whose every joint has digits that float32 cannot hold.
inline HandJoints sample_hand(Side side) {
  const double s = side == Side::right ? 1.0 : -1.0;
  HandJoints hand;
  hand.id = side == Side::right ? 31 : 32;
  hand.side = side;
  hand.confidence = 0.7f;
  hand.grab_strength = 0.3f;
  hand.pinch_strength = 0.1f;
  hand.palm_centre = Vector3(0.0123, 0.2, 0.1 * s);
  hand.palm_width = 0.0851f;
  hand.wrist = hand.palm_centre.value() + Vector3(-0.0654321, 0.00123, 0.0081 * s);
  for (std::size_t f = 0; f < kFingers; ++f) {
    hand.finger_width[f] = 0.0191f - 0.001f * static_cast<float>(f);
    const double across = s * (f == 0 ? -0.03 : -0.023 + 0.019 * static_cast<double>(f - 1));
    const double along[5] = {f == 0 ? -0.051 : -0.0417, f == 0 ? -0.051 : 0.0213, 0.059, 0.0841, 0.1013};
    const std::size_t lowest = f == 0 ? 1 : 0;  // the thumb's metacarpal has length zero
    for (std::size_t j = 0; j < 5; ++j)
      hand.joints[f][j] =
          hand.palm_centre.value() +
          Vector3(along[j], 0.0031 - 0.0009 * static_cast<double>(std::max(j, lowest)), across);
  }
  return hand;
}

/// Two hands, one, one without a wrist, and none.
inline std::vector<JointsFrame> sample_frames() {
  JointsFrame no_wrist{1700000000123456789, {sample_hand(Side::left)}};
  no_wrist.hands[0].wrist.reset();
  return {{1000016000001, {sample_hand(Side::right), sample_hand(Side::left)}},
          {1000024000000, {sample_hand(Side::right)}},
          no_wrist,
          {7, {}}};
}

inline void expect_same_bits(const Hand& a, const Hand& b) {
  EXPECT_EQ(a.id, b.id);
  EXPECT_EQ(a.side, b.side);
  EXPECT_EQ(a.confidence, b.confidence);
  EXPECT_EQ(a.grab_strength, b.grab_strength);
  EXPECT_EQ(a.pinch_strength, b.pinch_strength);
  EXPECT_EQ(a.palm.position, b.palm.position);
  EXPECT_EQ(a.palm.orientation.coeffs(), b.palm.orientation.coeffs());
  EXPECT_EQ(a.palm_width, b.palm_width);
  EXPECT_EQ(a.wrist, b.wrist);
  for (std::size_t i = 0; i < kCapsules; ++i) {
    EXPECT_EQ(a.capsules[i].start, b.capsules[i].start);
    EXPECT_EQ(a.capsules[i].end, b.capsules[i].end);
    EXPECT_EQ(a.capsules[i].radius, b.capsules[i].radius);
  }
}

}  // namespace mrhi
