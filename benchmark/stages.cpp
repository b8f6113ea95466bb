// Time of each stage of a step: medians in scene (a), alone and with far cubes. The measured cost of the
// clock is subtracted.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <vector>

#include "support/pinch_scene.h"

namespace mrhi {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int kSettle = 1000, kMeasured = 10000;
constexpr double kSway = 0.1;  // [m]

Vector3 sway_at(double t, double amplitude) {
  return testing::smooth(t - 0.5, 0.5) * testing::swing(t - 0.5, amplitude, 0.5);
}

double nanoseconds(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double, std::nano>(to - from).count();
}

double median(std::vector<double>& values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

/// Measured duration of an empty stage [ns].
double clock_cost() {
  std::vector<double> empty;
  for (int i = 0; i < kMeasured; ++i) {
    const Clock::time_point from = Clock::now();
    empty.push_back(nanoseconds(from, Clock::now()));
  }
  return median(empty);
}

Scene scene_with_far_cubes(int far) {
  Scene scene = testing::PinchScene().scene();
  for (int i = 0; i < far; ++i) {
    Body cube = testing::box_body(Vector3::Constant(0.05), 0.1);
    cube.name = "far" + std::to_string(i);
    cube.start.position = Vector3(0.6 + 0.2 * (i % 4), 0.2 * (i / 4), 0.5);
    scene.bodies.push_back(cube);
  }
  return scene;
}

void measure(int far) {
  const testing::PinchScene pinch;
  Simulation simulation(scene_with_far_cubes(far), testing::unfiltered(ContactModelKind::implicit));
  std::array<std::vector<double>, kStages> stages;
  std::vector<double> steps;
  Clock::time_point last;
  bool measuring = false;
  const double overhead = clock_cost();
  const auto advance = [&](int frame) {
    const double t = frame / 1000.0;
    const Vector3 sway = sway_at(t, kSway);
    simulation.begin({testing::at(t), {pinch.hand(t, sway)}});
    const Clock::time_point from = last = Clock::now();
    while (simulation.step()) {
    }
    if (measuring) steps.push_back(nanoseconds(from, Clock::now()) - overhead);
    simulation.end();
  };
  for (int frame = 0; frame < kSettle; ++frame) advance(frame);
  measuring = true;
  for (int frame = kSettle; frame < kSettle + kMeasured; ++frame) advance(frame);
  std::vector<double> whole;
  whole.swap(steps);
  simulation.watch([&](Stage stage) {
    const Clock::time_point now = Clock::now();
    stages[static_cast<std::size_t>(stage)].push_back(nanoseconds(last, now) - overhead);
    last = Clock::now();
  });
  for (int frame = kSettle + kMeasured; frame < kSettle + 2 * kMeasured; ++frame) advance(frame);
  std::printf("scene (a) and %d far cubes: %.2f us a step\n", far, 1e-3 * median(whole));
  for (int i = 0; i < kStages; ++i)
    std::printf("  %-14s %7.0f ns\n", to_string(static_cast<Stage>(i)),
                std::max(0.0, median(stages[static_cast<std::size_t>(i)])));
}

/// Median step of scene (a), with frames at `rate`, at which the hand's velocity changes [1/s].
double step_of_pinch(double rate, double amplitude) {
  const testing::PinchScene pinch;
  Simulation simulation(pinch.scene(), testing::unfiltered(ContactModelKind::implicit));
  std::vector<double> steps;
  const double overhead = clock_cost();
  for (int frame = 0; steps.size() < kMeasured; ++frame) {
    const double t = frame / rate;
    simulation.begin({testing::at(t), {pinch.hand(t, sway_at(t, amplitude))}});
    for (bool more = true; more;) {
      const Clock::time_point from = Clock::now();
      more = simulation.step();
      if (more && t > 1.0) steps.push_back(nanoseconds(from, Clock::now()) - overhead);
    }
    simulation.end();
  }
  return median(steps);
}

/// Two hands that each hold a cube among four more, one step per frame at 120 Hz: from the frame's arrival to
/// the rendered hands.
void measure_frame() {
  const testing::PinchScene pinch;
  const Vector3 apart(0.3, 0, 0);
  Scene scene = scene_with_far_cubes(4);
  Body second = pinch.scene().bodies[0];
  second.name = "second";
  second.start.position = apart;
  scene.bodies.push_back(second);
  Configuration configuration;
  configuration.step = 0.01;
  Simulation simulation(scene, configuration);
  std::vector<double> frames;
  const double overhead = clock_cost();
  for (int frame = 0; frame < 3000; ++frame) {
    const double t = frame / 120.0;
    const Vector3 sway = sway_at(t, kSway);
    Hand other = pinch.hand(t, apart + sway);
    other.id = 2;
    const HandFrame input{testing::at(t), {pinch.hand(t, sway), other}};
    const Clock::time_point from = Clock::now();
    simulation.advance(input);
    if (frame > 200) frames.push_back(nanoseconds(from, Clock::now()) - overhead);
  }
  std::printf("two hands, six cubes, one step a frame: %.2f us a frame\n", 1e-3 * median(frames));
}

}  // namespace
}  // namespace mrhi

int main() {
  mrhi::measure(0);
  std::printf("a step of it with the hand at rest: %.2f us; swung, tracked at 120 Hz: %.2f us\n",
              1e-3 * mrhi::step_of_pinch(1000.0, 0.0), 1e-3 * mrhi::step_of_pinch(120.0, mrhi::kSway));
  mrhi::measure(19);
  mrhi::measure_frame();
  return 0;
}
