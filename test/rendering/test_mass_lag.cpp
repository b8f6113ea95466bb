// The rendered hand lags behind what it accelerates, so that a heavy object looks heavy.

#include <gtest/gtest.h>

#include "mr_hand_interaction/response/contact_model.h"
#include "rendering/renderer.h"
#include "simulation/state_bytes.h"
#include "support/pinch_scene.h"

namespace mrhi {
namespace {

using namespace testing;

constexpr double kRatio = 1.5, kPeriod = 1.0 / 120.0;
/// By so much the renderer keeps the pads of this pinch outside of the cube, without a lag [m].
constexpr double kKeptOut = 2e-4;

/// A cube of `mass` in a firm pinch, which moves by path(t) along y, at right angles to the pinch.
class Carried {
 public:
  explicit Carried(double mass, double ratio = kRatio, const Vector3& gravity = Vector3::Zero()) {
    pinch_.mass = mass;
    pinch_.stiffness = 20000.0;
    Configuration configuration = unfiltered(ContactModelKind::implicit);
    configuration.control_display_ratio = ratio;
    configuration.gravity = gravity;
    simulation_.emplace(pinch_.scene(), configuration);
  }
  template <class Path>
  void run(double until, const Path& path) {
    for (; time_ < until; time_ += kPeriod) {
      const Hand hand = pinch_.hand(time_, Vector3(0, path(time_), 0));
      ASSERT_EQ(simulation_->advance({at(time_), {hand}}), Rejection::none);
      largest_ = std::max(largest_, lag().norm());
    }
  }
  /// Displacement of the rendered hand from the tracked one.
  Vector3 lag() const {
    const FrameResult& result = simulation_->result();
    return result.rendered.at(0).hand.palm.position - result.tracked.at(0).palm.position;
  }
  double largest() const { return largest_; }
  double moved() const { return simulation_->result().tracked.at(0).palm.position.y(); }
  const BodyState& cube() const { return simulation_->state().bodies.front(); }
  Simulation& simulation() { return *simulation_; }

 private:
  PinchScene pinch_;
  std::optional<Simulation> simulation_;
  double time_ = 0.0, largest_ = 0.0;
};

double reach(double t) {
  return 0.2 * smooth(t - 0.5, 1.0);
}

TEST(MassLag, rendered_hand_lags_the_more_the_heavier_what_it_accelerates_and_returns) {
  double before = 0.0;
  for (const double mass : {0.02, 0.2, 2.0, 20.0}) {
    Carried carried(mass);
    carried.run(0.9, reach);  // it accelerates
    const double lag = -carried.lag().y();
    EXPECT_GT(lag, 1.2 * before) << mass << " kg";
    EXPECT_GE(lag, 0.0);
    before = lag;
    carried.run(4.0, reach);
    EXPECT_LT(carried.lag().norm(), kKeptOut) << mass << " kg";
    EXPECT_LT(carried.simulation().state().mass_lags.at(0).displacement.norm(), 1e-5) << mass << " kg";
  }
  EXPECT_GT(before, 0.006);  // 20 kg are seen
}

/// What the object does is of the tracked hand, and without a lag the rendered hand is the tracked one.
TEST(MassLag, off_and_on_the_object_moves_by_the_same_bits) {
  Carried off(20.0, 1.0), on(20.0);
  double lagged = 0.0;
  for (double t = 0.1; t < 2.0; t += 0.1) {
    off.run(t, reach), on.run(t, reach);
    ASSERT_EQ(off.cube().pose.position, on.cube().pose.position);
    ASSERT_EQ(off.cube().linear_momentum, on.cube().linear_momentum);
    ASSERT_TRUE(off.simulation().state().mass_lags.at(0).zero());
    lagged = std::max(lagged, on.simulation().state().mass_lags.at(0).displacement.norm());
  }
  EXPECT_GT(lagged, 0.004);
}

TEST(MassLag, there_is_none_at_constant_speed_nor_in_a_hand_that_carries_weight_at_rest) {
  Carried glides(20.0);
  const auto path = [](double t) { return 0.2 * (std::max(0.0, t - 1.0) + 0.5 * smooth(t - 0.5, 1.0)); };
  glides.run(5.0, path);
  EXPECT_LT(glides.lag().norm(), kKeptOut);
  EXPECT_LT(glides.simulation().state().mass_lags.at(0).displacement.norm(), 1e-5);
  EXPECT_GT(glides.largest(), 0.003);  // it had to start

  Carried weighs(1.0, kRatio, Vector3(0, 0, -9.81));
  weighs.run(1.0, [](double) { return 0.0; });  // it drops into the grip at first
  weighs.run(4.0, [](double) { return 0.0; });
  EXPECT_LT(weighs.lag().norm(), 1e-3);
}

/// From rest to speed in any time, tracked / rendered displacement is at most the mass's ratio. The
/// acceleration is given, so that this is the law alone.
TEST(MassLag, control_to_display_ratio_of_a_hand_that_sets_off_is_at_most_the_masss) {
  for (const double mass : {0.1, 5.0, 20.0, 1000.0}) {
    const double ratio = control_display_ratio(kRatio, mass);
    EXPECT_LT(ratio, kRatio);
    double worst = 1.0;
    for (const double duration : {0.05, 0.2, 1.0, 5.0}) {
      MassLag lag;
      const auto path = [&](double t) { return 0.1 * smooth(t, duration); };
      for (double t = 0.0; t < 2.0 * duration; t += kPeriod) {
        // Mean acceleration of the frame, by the displacements of the frames around it.
        const double a = (path(t) - 2.0 * path(t - kPeriod) + path(t - 2.0 * kPeriod)) / (kPeriod * kPeriod);
        advance_mass_lag(kRatio, {mass, Vector3(a, 0, 0)}, at(t), lag);
        const double shown = path(t) + lag.displacement.x();
        if (path(t) > 0.005) worst = std::max(worst, path(t) / shown);
      }
    }
    EXPECT_LE(worst, ratio + 0.02) << mass << " kg: frames are 1/6 of the shortest movement";
    EXPECT_GT(worst, 1.0 + 0.7 * (ratio - 1.0)) << mass << " kg";
  }
}

TEST(MassLag, is_never_longer_than_its_limit_and_zero_without_acceleration) {
  MassLag lag, none;
  double longest = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3 wild(900.0 * std::sin(0.1 * i), 700.0 * std::cos(0.023 * i), i % 7 == 0 ? 500.0 : -80.0);
    advance_mass_lag(2.0, {50.0, wild}, at(i * kPeriod), lag);
    advance_mass_lag(2.0, {50.0, Vector3::Zero()}, at(i * kPeriod), none);
    longest = std::max(longest, lag.displacement.norm());
    ASSERT_TRUE(none.zero());
  }
  EXPECT_LE(longest, kMaxMassLag * (1.0 + 1e-12));
  EXPECT_GT(longest, 0.9 * kMaxMassLag);
}

TEST(MassLag, is_saved_and_goes_on_from_a_saved_state_with_the_same_bits) {
  Carried whole(20.0);
  whole.run(0.9, reach);
  const std::string bytes = to_bytes(whole.simulation().state());
  ASSERT_FALSE(whole.simulation().state().mass_lags.at(0).zero());
  const SimulationState saved = whole.simulation().state();
  whole.run(1.5, reach);
  const std::uint64_t end = hash(whole.simulation().state());
  Carried other(20.0);
  other.run(0.9, [](double) { return 0.0; });  // elsewhere, at the same time
  other.simulation().set_state(state_from_bytes(bytes, other.simulation().scene()));
  EXPECT_EQ(hash(other.simulation().state()), hash(saved));
  other.run(1.5, reach);
  EXPECT_EQ(hash(other.simulation().state()), end);
}

}  // namespace
}  // namespace mrhi
