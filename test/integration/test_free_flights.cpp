#include "integration/free_flights.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "integration/free_flight.h"

namespace mrhi {
namespace {

constexpr std::size_t kBodies = 41;  // the last four are not full

class Numbers {
 public:
  double operator()(double scale) { return std::uniform_real_distribution<double>(-scale, scale)(random_); }
  Vector3 vector(double scale) { return {(*this)(scale), (*this)(scale), (*this)(scale)}; }
  bool heads() { return (*this)(1.0) > 0.0; }

 private:
  std::mt19937 random_{7};
};

/// Bodies of all kinds that turn slowly, fast or not at all, and fixtures.
Scene scene_of_all_kinds(Numbers& number) {
  Scene scene;
  for (std::size_t b = 0; b < kBodies; ++b) {
    Body body;
    body.name = std::to_string(b);
    body.mass = 0.1 + std::abs(number(0.1));
    const double last = b % 3 == 0 ? 2.0 : 2.5, first = b % 4 == 0 ? 2.0 : 1.0;
    const Matrix3 moments = 1e-4 * Vector3(first, 2.0, last).asDiagonal();
    const Matrix3 axes = b % 2 == 0
                             ? Matrix3(Matrix3::Identity())
                             : Eigen::AngleAxisd(number(3.0), number.vector(1.0).normalized()).matrix();
    const Matrix3 inertia = axes * moments * axes.transpose();
    body.inertia = 0.5 * (inertia + inertia.transpose());
    body.fixed = b % 13 == 5;
    body.start.orientation = Eigen::AngleAxisd(number(3.0), number.vector(1.0).normalized());
    if (b % 7 != 3) body.start_twist = {number.vector(1.0), number.vector(b % 5 == 0 ? 100.0 : 10.0)};
    complete(body);
    scene.bodies.push_back(body);
  }
  return scene;
}

std::vector<BodyState> start_of(const Scene& scene) {
  std::vector<BodyState> states;
  for (const Body& body : scene.bodies) states.push_back(start_state(body));
  return states;
}

template <typename Numbers>
bool same_bits(const Numbers& a, const Numbers& b) {
  return std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(double)) == 0;
}

void expect_same_bits(const std::vector<BodyState>& a, const std::vector<BodyState>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_TRUE(same_bits(a[i].pose.position, b[i].pose.position)) << i;
    EXPECT_TRUE(same_bits(a[i].pose.orientation.coeffs(), b[i].pose.orientation.coeffs())) << i;
    EXPECT_TRUE(same_bits(a[i].linear_momentum, b[i].linear_momentum)) << i;
    EXPECT_TRUE(same_bits(a[i].angular_momentum, b[i].angular_momentum)) << i;
  }
}

// Any of the bodies, each for its own time: which of them share registers is not seen.
TEST(FreeFlights, bodies_fly_to_the_same_bits_as_each_alone) {
  Numbers number;
  const Scene scene = scene_of_all_kinds(number);
  const Vector3 gravity(0.0, 0.0, -9.81);
  FreeFlights flights(scene);
  std::vector<BodyState> states = start_of(scene), alone = states;
  for (int step = 0; step < 200; ++step) {
    for (std::size_t b = 0; b < kBodies; ++b) {
      if (step % 3 == 0 && number.heads()) continue;
      const double seconds = step % 2 == 0 ? 0.001 : 0.001 + std::abs(number(0.01));
      flights.fly(b, gravity, seconds, states[b]);
      free_flight(scene.bodies[b], gravity, seconds, alone[b]);
    }
    flights.turn(states);
  }
  expect_same_bits(states, alone);
}

TEST(FreeFlights, what_flew_before_leaves_no_trace) {
  Numbers number;
  const Scene scene = scene_of_all_kinds(number);
  FreeFlights flights(scene);
  std::vector<BodyState> states = start_of(scene);
  const auto fly = [&](FreeFlights& with, std::vector<BodyState>& of) {
    for (int step = 0; step < 50; ++step) {
      for (std::size_t b = 0; b < kBodies; ++b) with.fly(b, Vector3::Zero(), 0.001, of[b]);
      with.turn(of);
    }
  };
  fly(flights, states);
  std::vector<BodyState> saved = states;
  FreeFlights anew(scene);
  fly(flights, states);
  fly(anew, saved);
  expect_same_bits(states, saved);
}

/// Filled with numbers as they are where bodies turn.
Turning<Lanes> any_states(Numbers& number) {
  Turning<Lanes> states{};
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const Quaternion q(Eigen::AngleAxisd(number(3.0), number.vector(1.0).normalized()));
    states.w.lane[lane] = q.w(), states.x.lane[lane] = q.x(), states.y.lane[lane] = q.y(),
    states.z.lane[lane] = q.z();
    for (Lanes* momentum : {&states.momentum.x, &states.momentum.y, &states.momentum.z})
      momentum->lane[lane] = number(1e-3);
    states.seconds.lane[lane] = 0.001;
  }
  return states;
}

TEST(FreeFlights, every_kind_of_processor_gives_the_same_bits) {
  if (short_turns() == kPortableTurns) GTEST_SKIP() << "this processor has no wider registers";
  Numbers number;
  for (int round = 0; round < 1000; ++round) {
    Spinner<Lanes> bodies{};
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const Matrix3 axes = Eigen::AngleAxisd(number(3.0), number.vector(1.0).normalized()).toRotationMatrix();
      for (int i = 0; i < 3; ++i) {
        bodies.axes[i].x.lane[lane] = axes(0, i), bodies.axes[i].y.lane[lane] = axes(1, i),
        bodies.axes[i].z.lane[lane] = axes(2, i);
        bodies.moments[i].lane[lane] = 4e3 + 3e3 * i + number(1e3);
      }
    }
    Turning<Lanes> portable = any_states(number), wide = portable;
    kPortableTurns(bodies, portable);
    kAvx2Turns(bodies, wide);
    ASSERT_EQ(std::memcmp(&portable, &wide, sizeof wide), 0) << round;
  }
}

}  // namespace
}  // namespace mrhi
