#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <random>
#include <set>
#include <sstream>

#include "mr_hand_interaction/parameters.h"
#include "mr_hand_interaction/simulation.h"
#include "support/fixtures.h"
#include "text/text.h"
#include "tracking/hand_filter.h"

namespace mrhi {
namespace {

constexpr double kFrame = 1.0 / 120.0;  // [s]
constexpr std::size_t kTip = capsule_index(1, 3), kMiddle = capsule_index(1, 2);

Hand hand_at(double x) {
  return testing::finger(Vector3(x, 0, 0), Vector3(x, 0, 0.02), 0.008);
}

FilterConfiguration filter_of(FilterKind kind) {
  FilterConfiguration filter;
  filter.type = kind;
  return filter;
}

Hand last_of(const std::vector<Hand>& oldest_first, const FilterConfiguration& filter) {
  FilterMemory memory;
  Hand last;
  for (const Hand& hand : oldest_first) last = filtered(hand, kFrame, filter, memory);
  return last;
}

double x_after(const std::vector<double>& oldest_first, const FilterConfiguration& filter) {
  std::vector<Hand> hands;
  for (const double x : oldest_first) hands.push_back(hand_at(x));
  return last_of(hands, filter).capsules[kTip].start.x();
}

const FilterConfiguration kWindow = filter_of(FilterKind::window);
const FilterConfiguration kOneEuro = filter_of(FilterKind::one_euro);
const FilterConfiguration kConstantVelocity = filter_of(FilterKind::constant_velocity);

TEST(WindowFilter, is_the_mean_of_the_last_F_frames_with_gain_one) {
  EXPECT_NEAR(x_after({9.0, 1.0, 2.0, 6.0}, kWindow), 3.0, 1e-15);  // F = 3
  // Eq. 1 as printed would give 1/3.
  EXPECT_DOUBLE_EQ(x_after({0.25, 0.25, 0.25, 0.25}, kWindow), 0.25);
}

TEST(WindowFilter, is_the_mean_of_palm_and_wrist_too) {
  std::vector<Hand> hands{hand_at(0), hand_at(0), hand_at(0)};
  for (std::size_t i = 0; i < hands.size(); ++i) {
    hands[i].palm.position = static_cast<double>(i) * Vector3(3, 0, 0);
    hands[i].wrist = static_cast<double>(i) * Vector3(0, 3, 0);
  }
  const Hand mean = last_of(hands, kWindow);
  EXPECT_NEAR((mean.palm.position - Vector3(3, 0, 0)).norm(), 0.0, 1e-15);
  EXPECT_NEAR((mean.wrist - Vector3(0, 3, 0)).norm(), 0.0, 1e-15);
}

TEST(WindowFilter, takes_fewer_frames_at_the_start) {
  EXPECT_DOUBLE_EQ(x_after({1.0}, kWindow), 1.0);
  EXPECT_DOUBLE_EQ(x_after({1.0, 2.0}, kWindow), 1.5);
}

TEST(WindowFilter, none_gives_the_newest_sample) {
  EXPECT_DOUBLE_EQ(x_after({1.0, 2.0}, filter_of(FilterKind::none)), 2.0);
}

TEST(WindowFilter, orientation_mean_lies_halfway_and_ignores_the_quaternions_sign) {
  FilterConfiguration filter = kWindow;
  filter.window = 2;
  Hand a = hand_at(0), b = hand_at(0);
  a.palm.orientation = Eigen::AngleAxisd(0.2, Vector3::UnitY());
  b.palm.orientation = Eigen::AngleAxisd(1.0, Vector3::UnitY());
  b.palm.orientation.coeffs() = -b.palm.orientation.coeffs();
  const Quaternion expected(Eigen::AngleAxisd(0.6, Vector3::UnitY()));
  EXPECT_LE(last_of({a, b}, filter).palm.orientation.angularDistance(expected), 1e-7);
}

TEST(WindowFilter, a_finger_that_was_missing_is_averaged_from_when_it_is_back) {
  Hand without = hand_at(5.0);
  without.capsules[kTip].radius = 0.0;
  EXPECT_DOUBLE_EQ(last_of({hand_at(100.0), without, hand_at(1.0)}, kWindow).capsules[kTip].start.x(), 1.0);
  EXPECT_FALSE(last_of({hand_at(100.0), without, hand_at(1.0), without}, kWindow).has(kTip));
}

TEST(WindowFilter, delays_a_steady_motion_by_half_the_window_less_one) {
  // One frame behind at F = 3.
  EXPECT_NEAR(x_after({0.0, 0.01, 0.02, 0.03}, kWindow), 0.02, 1e-15);
}

// First-order low-pass: the share x/(1 + x) of a step is taken at once, x = 2 pi cutoff elapsed.
TEST(OneEuroFilter, of_a_hand_at_rest_is_a_low_pass_at_min_cutoff) {
  FilterConfiguration filter = kOneEuro;
  filter.beta = 0.0;
  const double x = 2.0 * M_PI * filter.min_cutoff * kFrame;
  EXPECT_NEAR(x_after({0.0, 1.0}, filter), x / (1.0 + x), 1e-12);
}

// A first-order low-pass stays 1/(2 pi cutoff) behind a steady motion.
TEST(OneEuroFilter, lags_the_less_the_faster_the_hand_moves) {
  for (const double speed : {0.01, 0.1, 1.0}) {
    std::vector<double> way;
    for (int i = 0; i < 240; ++i) way.push_back(i * kFrame * speed);
    const double lag = (way.back() - x_after(way, kOneEuro)) / speed;  // [s]
    EXPECT_NEAR(lag, 1.0 / (2.0 * M_PI * (kOneEuro.min_cutoff + kOneEuro.beta * speed)), 1e-6) << speed;
  }
}

TEST(ConstantVelocityFilter, does_not_lag_behind_a_steady_motion) {
  std::vector<double> way;
  for (int i = 0; i < 240; ++i) way.push_back(0.3 * i * kFrame);
  EXPECT_NEAR(x_after(way, kConstantVelocity), way.back(), 1e-9);
}

TEST(ConstantVelocityFilter, takes_the_second_sample_of_a_hand_that_has_just_appeared_nearly_as_it_is) {
  const double way = 0.5 * kFrame;  // at half a metre a second
  EXPECT_GT(x_after({0.0, way}, kConstantVelocity), 0.95 * way);
}

// Two samples fix a line, so the second is taken nearly as it is; from there on the gain falls to what it is
// in the long run, which for white acceleration is Kalata's (1984) with the tracking index a T^2 / noise.
TEST(ConstantVelocityFilter, gain_settles_at_that_of_the_tracking_index) {
  FilterConfiguration filter = kConstantVelocity;
  filter.agility = 0.0;
  filter.noise = 0.0007;
  FilterMemory memory;
  for (int i = 0; i < 2000; ++i) filtered(hand_at(0.0), kFrame, filter, memory);
  const double index = filter.acceleration * kFrame * kFrame / *filter.noise;
  const double root = 0.25 * (4.0 + index - std::sqrt(8.0 * index + index * index));
  EXPECT_NEAR(filtered(hand_at(1.0), kFrame, filter, memory).capsules[kTip].start.x(), 1.0 - root * root,
              1e-6);
}

TEST(ConstantVelocityFilter, a_turning_palm_is_followed_without_lag_through_a_full_turn) {
  FilterMemory memory;
  const auto turned = [](int frame) {
    Hand hand = hand_at(0.0);
    hand.palm.orientation = Eigen::AngleAxisd(3.0 * frame * kFrame, Vector3(0.6, 0.0, 0.8));
    return hand;
  };
  Hand last;
  for (int i = 0; i < 480; ++i) {
    last = filtered(turned(i), kFrame, kConstantVelocity, memory);
    EXPECT_NEAR(last.palm.orientation.norm(), 1.0, 1e-12);
  }
  EXPECT_LE(last.palm.orientation.angularDistance(turned(479).palm.orientation), 1e-7);
}

/// One finger of a hand that stands still, or sways by 0.1 m every two seconds, with white noise of 0.2 mm.
class NoisyFinger {
 public:
  explicit NoisyFinger(bool sways) : sways_(sways) {}

  double x(double t) const { return sways_ ? 0.1 * std::sin(M_PI * t) : 0.0; }
  double speed(double t) const { return sways_ ? 0.1 * M_PI * std::cos(M_PI * t) : 0.0; }

  struct Outcome {
    double rms, lag;  // [m], [s]
  };
  Outcome through(const FilterConfiguration& filter) const {
    std::mt19937 random(1);
    std::normal_distribution<double> noise(0.0, 0.0002);
    FilterMemory memory;
    double squares = 0.0, along = 0.0, speeds = 0.0;
    for (int i = 0; i < kFrames; ++i) {
      const double t = i * kFrame;
      const Hand hand = filtered(hand_at(x(t) + noise(random)), kFrame, filter, memory);
      const double behind = x(t) - hand.capsules[kTip].start.x();
      if (t < 1.0) continue;
      squares += behind * behind / (kFrames - 120);
      along += behind * speed(t);
      speeds += speed(t) * speed(t);
    }
    return {std::sqrt(squares), speeds > 0.0 ? along / speeds : 0.0};
  }

 private:
  static constexpr int kFrames = 120 + 4800;
  bool sways_;
};

// docs/pipeline.md has the same of real hands.
TEST(DefaultFilter, has_at_most_half_the_lag_of_F_3_and_no_more_jitter) {
  const FilterConfiguration shipped;
  EXPECT_LE(NoisyFinger(false).through(shipped).rms, NoisyFinger(false).through(kWindow).rms);
  const double lag = NoisyFinger(true).through(shipped).lag;
  const double lag_of_three = NoisyFinger(true).through(kWindow).lag;
  EXPECT_NEAR(lag_of_three, kFrame, 0.02 * kFrame);
  EXPECT_LE(lag, 0.5 * lag_of_three);
}

class EveryFilter : public ::testing::TestWithParam<FilterKind> {
 protected:
  const FilterConfiguration filter_ = filter_of(GetParam());
};

TEST_P(EveryFilter, leaves_a_still_hand_where_it_is) {
  EXPECT_NEAR(x_after(std::vector<double>(50, 0.25), filter_), 0.25, 1e-15);
}

TEST_P(EveryFilter, gives_the_first_sample_as_it_is) {
  EXPECT_EQ(x_after({0.7}, filter_), 0.7);
}

TEST_P(EveryFilter, keeps_the_joint_that_two_bones_share_one_point) {
  FilterMemory memory;
  for (int i = 0; i < 40; ++i) {
    const double x = 0.1 * std::sin(0.3 * i);
    Hand hand = hand_at(x);
    hand.capsules[kMiddle] = {Vector3(x - 0.03, 0.02 * x, 0), hand.capsules[kTip].start, 0.008};
    const Hand smooth = filtered(hand, i % 3 == 0 ? 0.7 * kFrame : kFrame, filter_, memory);
    EXPECT_EQ(smooth.capsules[kMiddle].end, smooth.capsules[kTip].start);
  }
}

TEST_P(EveryFilter, takes_up_a_finger_that_was_missing_where_it_is) {
  Hand without = hand_at(0.0);
  without.capsules[kTip].radius = 0.0;
  EXPECT_FALSE(last_of({hand_at(0.0), without}, filter_).has(kTip));
  EXPECT_DOUBLE_EQ(last_of({hand_at(5.0), without, hand_at(1.0)}, filter_).capsules[kTip].start.x(), 1.0);
}

TEST_P(EveryFilter, a_copy_of_its_memory_goes_on_with_the_same_bits) {
  FilterMemory memory;
  for (int i = 0; i < 20; ++i) filtered(hand_at(0.01 * i * i), kFrame, filter_, memory);
  FilterMemory copy = memory;
  for (int i = 0; i < 20; ++i) {
    const Hand a = filtered(hand_at(0.02 * i), kFrame, filter_, memory);
    const Hand b = filtered(hand_at(0.02 * i), kFrame, filter_, copy);
    EXPECT_EQ(a.capsules[kTip].start, b.capsules[kTip].start);
    EXPECT_EQ(a.palm.orientation.coeffs(), b.palm.orientation.coeffs());
  }
}

TEST_P(EveryFilter, keeps_its_gain_of_one_at_uneven_intervals) {
  FilterMemory memory;
  double t = 0.0;
  Hand last;
  for (int i = 0; i < 300; ++i) {
    const double elapsed = kFrame * (i % 2 == 0 ? 0.5 : 1.5);
    t += elapsed;
    last = filtered(hand_at(0.2 * t), elapsed, filter_, memory);
  }
  EXPECT_NEAR(last.capsules[kTip].start.x(), 0.2 * t, 0.2 * 2.0 * kFrame);
  for (int i = 0; i < 300; ++i) last = filtered(hand_at(0.2 * t), kFrame, filter_, memory);
  EXPECT_NEAR(last.capsules[kTip].start.x(), 0.2 * t, 1e-9);
}

std::vector<FilterKind> every_kind() {
  std::vector<FilterKind> kinds;
  for (const HandFilter* filter : hand_filters()) kinds.push_back({filter->name});
  return kinds;
}

INSTANTIATE_TEST_SUITE_P(kinds, EveryFilter, ::testing::ValuesIn(every_kind()),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST(HandFilters, have_names_of_their_own_and_keep_the_places_that_recorded_states_know) {
  std::set<std::string> names;
  for (const HandFilter* filter : hand_filters()) names.insert(filter->name);
  EXPECT_EQ(names.size(), hand_filters().size());
  const FilterKind recorded[] = {FilterKind::none, FilterKind::window, FilterKind::one_euro,
                                 FilterKind::constant_velocity};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(hand_filters().at(i)->name, recorded[i].name);
    EXPECT_EQ(hand_filters().at(i)->place, static_cast<int>(i));
  }
}

TEST(HandFilters, can_be_set_by_name_and_so_can_each_of_their_numbers) {
  for (const HandFilter* filter : hand_filters()) {
    Configuration configuration;
    set_parameter(configuration, "filter/type", filter->name);
    EXPECT_EQ(configuration.filter.type.name, filter->name);
    for (const FilterSetting& setting : filter->settings()) {
      const std::string name = std::string("filter/") + setting.name;
      set_parameter(configuration, name, text::exact(setting.range.max));
      EXPECT_EQ(std::stod(parameter_text(configuration, name)), setting.range.max) << name;
    }
  }
}

TEST(HandFilters, one_that_is_not_known_is_refused_by_name_before_a_hand_comes) {
  Configuration configuration;
  configuration.filter.type = {"kalman"};
  try {
    Simulation simulation(Scene(), configuration);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "filter 'kalman' is not known; allowed: none, window, one_euro, constant_velocity");
  }
}

// What cannot ask the registry: what people read, and Tune.cfg, which reads default.yaml.
TEST(HandFilters, are_told_with_their_numbers_where_people_look) {
  for (const char* file : {"config/default.yaml", "docs/pipeline.md"}) {
    std::ostringstream stream;
    stream << std::ifstream(file).rdbuf();
    const std::string text = stream.str();
    ASSERT_FALSE(text.empty()) << file;
    for (const HandFilter* filter : hand_filters()) {
      EXPECT_NE(text.find(filter->name), std::string::npos) << filter->name << " is not in " << file;
      for (const FilterSetting& setting : filter->settings())
        EXPECT_NE(text.find(setting.name), std::string::npos) << setting.name << " is not in " << file;
    }
  }
}

}  // namespace
}  // namespace mrhi
