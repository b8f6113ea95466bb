#include "mr_hand_interaction/synthetic/synthetic_hand.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mr_hand_interaction/tracking/hand_skeleton.h"

namespace mrhi {
namespace {

/// The same hand in every frame, or one that flies along x at 2 m/s.
JointsFrame frame_at(int index, double speed) {
  JointsFrame frame;
  frame.stamp = Nanoseconds{10'000'000} * index;
  const Pose wrist{{speed * to_seconds(frame.stamp), 0.2, 0.0}, Quaternion::Identity()};
  frame.hands.push_back(hand_joints(human_hand(), Side::right, wrist, relaxed_posture()));
  return frame;
}

/// Rms per axis of the index tip relative to the middle finger's, which is free of the common part, over
/// sqrt 2.
double joint_rms(double amplitude, double speed) {
  constexpr int kFrames = 2000;
  TrackingNoise noise(amplitude, 7);
  double sum = 0.0;
  for (int i = 0; i < kFrames; ++i) {
    const JointsFrame clean = frame_at(i, speed);
    JointsFrame noisy = clean;
    noise.apply(noisy);
    const auto error = [&](std::size_t finger) -> Vector3 {
      return *noisy.hands[0].joints[finger][4] - *clean.hands[0].joints[finger][4];
    };
    if (i > 0) sum += (error(1) - error(2)).squaredNorm();
  }
  return std::sqrt(sum / (3.0 * 2.0 * (kFrames - 1)));
}

TEST(TrackingNoise, is_a_fifth_of_a_millimetre_on_a_still_hand_and_six_times_that_on_a_fast_one) {
  // 6000 samples: the rms itself scatters by 1 %.
  EXPECT_NEAR(joint_rms(1.0, 0.0), 0.0002, 0.00001);
  EXPECT_NEAR(joint_rms(1.0, 2.0), 0.0012, 0.00006);
  EXPECT_NEAR(joint_rms(0.5, 0.0), 0.0001, 0.000005);
}

TEST(TrackingNoise, is_the_same_for_the_same_seed_and_another_for_another) {
  JointsFrame first = frame_at(0, 0.0), second = first, third = first;
  TrackingNoise(1.0, 3).apply(first);
  TrackingNoise(1.0, 3).apply(second);
  TrackingNoise(1.0, 4).apply(third);
  EXPECT_EQ(first.hands[0].joints, second.hands[0].joints);
  EXPECT_NE(first.hands[0].joints, third.hands[0].joints);
}

TEST(TrackingNoise, leaves_every_bit_alone_at_amplitude_zero) {
  JointsFrame frame = frame_at(0, 0.0);
  TrackingNoise(0.0, 3).apply(frame);
  EXPECT_EQ(frame.hands[0].joints, frame_at(0, 0.0).hands[0].joints);
}

}  // namespace
}  // namespace mrhi
