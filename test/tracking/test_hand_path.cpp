#include <gtest/gtest.h>

#include "mr_hand_interaction/tracking/hand_track.h"

namespace mrhi {
namespace {

constexpr std::size_t kThumbTip = 3;  // of the thumb

/// A hand of one bone whose points are all at x along the x axis.
class PathOfAHand : public ::testing::Test {
 protected:
  void go_to(double x, double elapsed) {
    Hand hand;
    hand.palm.position.x() = x;
    hand.capsules[kThumbTip] = {Vector3(x, 0, 0), Vector3(x, 0.02, 0), 0.008};
    track_.previous = frames_++ == 0 ? hand : track_.current;
    track_.current = hand;
    if (frames_ == 1) return;
    extend_path(elapsed, track_);
    elapsed_ = elapsed;
  }
  double position(double fraction) const {
    const double from = track_.previous.palm.position.x(), to = track_.current.palm.position.x();
    return from + PathWeights::at(fraction)(Vector3(to - from, 0, 0), track_.path.start_bend.points[0],
                                            track_.path.end_bend.points[0])
                      .x();
  }
  double velocity(double fraction) const {
    const double chord = track_.current.palm.position.x() - track_.previous.palm.position.x();
    return PathWeights::between(fraction, fraction, elapsed_)(
               Vector3(chord, 0, 0), track_.path.start_bend.points[0], track_.path.end_bend.points[0])
        .x();
  }

  HandTrack track_;
  int frames_ = 0;
  double elapsed_ = 0.0;
};

TEST_F(PathOfAHand, has_a_continuous_velocity_and_meets_every_pose) {
  double last = 0.0;
  for (int frame = 0; frame < 60; ++frame) {
    go_to(0.05 * std::sin(2.0 * M_PI * 2.0 * frame / 120.0), 1.0 / 120.0);
    if (frame < 2) continue;
    EXPECT_NEAR(position(0.0), track_.previous.palm.position.x(), 1e-15);
    EXPECT_NEAR(position(1.0), track_.current.palm.position.x(), 1e-15);
    if (frame > 6) {  // it starts amid a swing: the first bends are limited
      EXPECT_NEAR(velocity(0.0), last, 1e-12) << frame;
    }
    last = velocity(1.0);
  }
}

/// Five poses tell a polynomial of the fourth order, at even intervals and at uneven ones. The ratio of its
/// fourth difference counts as noise: a cubic has none.
TEST_F(PathOfAHand, follows_a_cubic_exactly_at_uneven_intervals) {
  double t = 0.0;
  const auto cubic = [](double at) { return 0.3 * at - 2.0 * at * at + 4.0 * at * at * at; };
  for (int frame = 0; frame < 12; ++frame) {
    const double elapsed = frame % 3 == 0 ? 1.0 / 60.0 : 1.0 / 120.0;
    t += elapsed;
    go_to(cubic(t), elapsed);
    if (frame < 6) continue;
    EXPECT_NEAR(position(0.5), cubic(t - 0.5 * elapsed), 1e-9) << frame;
    EXPECT_NEAR(velocity(1.0), 0.3 - 4.0 * t + 12.0 * t * t, 1e-6) << frame;
  }
}

TEST_F(PathOfAHand, swings_no_further_than_a_quarter_of_a_millimetre_past_a_stop) {
  const double speed = 1.0, elapsed = 1.0 / 60.0;
  const double stop = speed * elapsed * 10;
  for (int frame = 0; frame < 20; ++frame) {
    go_to(speed * elapsed * std::min(frame, 10), elapsed);
    for (double f = 0.0; f <= 1.0; f += 0.05) EXPECT_LE(position(f), stop + 2.5e-4) << frame;
  }
}

TEST_F(PathOfAHand, is_straight_where_the_hand_has_just_appeared) {
  go_to(0.0, 1.0);
  go_to(0.01, 1.0 / 60.0);
  EXPECT_DOUBLE_EQ(position(0.5), 0.005);
  EXPECT_NEAR(velocity(0.0), 0.6, 1e-12);
}

}  // namespace
}  // namespace mrhi
