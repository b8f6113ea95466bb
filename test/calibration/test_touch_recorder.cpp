#include <gtest/gtest.h>

#include <random>
#include <stdexcept>

#include "calibration/touch_recorder.h"

namespace {

using mrhi::TouchedPoint;
using mrhi::TouchRecorder;
using mrhi::Vector3;

constexpr std::size_t kSamples = 50;
constexpr double kRadius = 0.008;

std::vector<TouchedPoint> places(int count) {
  std::vector<TouchedPoint> points(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) points[static_cast<std::size_t>(i)].world.x() = 0.1 * i;
  return points;
}

/// How many points the recorder takes while the tip stays there for `frames`, as jittery as a Leap's.
std::size_t hold(TouchRecorder& recorder, const Vector3& at, int frames, double jitter = 0.0002) {
  static std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, jitter);
  const std::size_t before = recorder.taken();
  for (int i = 0; i < frames; ++i)
    recorder.add(at + Vector3(noise(random), noise(random), noise(random)), kRadius);
  return recorder.taken() - before;
}

TEST(TouchRecorder, TakesTheMeanOnceTheTipHasHeldStill) {
  TouchRecorder recorder(places(2), kSamples);
  const Vector3 place(0.1, 0.2, 0.0);
  EXPECT_EQ(hold(recorder, place, kSamples - 1), 0u);
  EXPECT_EQ(hold(recorder, place, 1), 1u);
  // Five standard deviations of a mean of three coordinates each.
  EXPECT_LT((*recorder.points()[0].device - place).norm(), 5.0 * 0.0002 * std::sqrt(3.0 / kSamples));
  EXPECT_EQ(recorder.points()[0].radius, kRadius);
  EXPECT_FALSE(recorder.points()[1].device);
}

TEST(TouchRecorder, ATipThatRestsWhereItWasIsNotTheNextPoint) {
  TouchRecorder recorder(places(2), kSamples);
  EXPECT_EQ(hold(recorder, {0.0, 0.0, 0.0}, 5 * kSamples), 1u);
  EXPECT_EQ(hold(recorder, {0.01, 0.0, 0.0}, 5 * kSamples), 0u);
  EXPECT_EQ(hold(recorder, {0.05, 0.0, 0.0}, 5 * kSamples), 1u);
  EXPECT_TRUE(recorder.done());
  EXPECT_FALSE(recorder.add({0.2, 0.0, 0.0}, kRadius));
}

TEST(TouchRecorder, AMovingTipIsNotTaken) {
  TouchRecorder recorder(places(1), kSamples);
  for (int i = 0; i < 500; ++i) EXPECT_FALSE(recorder.add({0.0005 * i, 0.0, 0.0}, kRadius));  // 6 cm/s
  EXPECT_EQ(hold(recorder, {1.0, 0.0, 0.0}, 3 * kSamples, 0.005), 0u);
}

TEST(TouchRecorder, ALostTipBeginsAnew) {
  TouchRecorder recorder(places(1), kSamples);
  EXPECT_EQ(hold(recorder, {0.0, 0.0, 0.0}, kSamples - 1), 0u);
  recorder.lose();
  EXPECT_EQ(hold(recorder, {0.0, 0.0, 0.0}, kSamples - 1), 0u);
  EXPECT_EQ(hold(recorder, {0.0, 0.0, 0.0}, 1), 1u);
}

TEST(TouchRecorder, RefusesToAverageNothingAndPointsThatItCouldNotTellApart) {
  EXPECT_THROW(TouchRecorder(places(2), 0), std::invalid_argument);
  auto points = places(3);
  points[2].world = points[0].world + Vector3(0.0, 0.02, 0.0);
  EXPECT_THROW(TouchRecorder(points, kSamples), std::invalid_argument);
}

}  // namespace
