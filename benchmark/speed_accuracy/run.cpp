#include "run.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace mrhi::benchmark {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kBlock = 4e-3;           // [s]
constexpr std::size_t kMaxSamples = 400'000;  // of step times; later ones replace earlier ones in turn

double microseconds(Clock::duration duration) {
  return std::chrono::duration<double, std::micro>(duration).count();
}

/// What two readings of the clock cost by themselves.
double clock_cost() {
  std::vector<double> costs;
  for (int i = 0; i < 1001; ++i) {
    const auto begin = Clock::now();
    costs.push_back(microseconds(Clock::now() - begin));
  }
  std::nth_element(costs.begin(), costs.begin() + 500, costs.end());
  return costs[500];
}

class Stopwatch {
 public:
  explicit Stopwatch(const std::function<void()>& pause) : pause_(pause), block_begin_(Clock::now()) {
    samples_.reserve(kMaxSamples);
  }

  void time(Engine& engine) {
    const auto begin = Clock::now();
    engine.step();
    const auto end = Clock::now();
    const auto sample = static_cast<float>(std::max(0.0, microseconds(end - begin) - clock_cost_));
    if (samples_.size() < kMaxSamples) {
      samples_.push_back(sample);
    } else {
      samples_[count_ % kMaxSamples] = sample;
    }
    ++count_;
    if (microseconds(end - block_begin_) < 1e6 * kBlock) return;
    pause_();
    block_begin_ = Clock::now();
  }

  StepTime result() {
    if (samples_.empty()) return {};
    return {percentile(0.5), percentile(0.99)};
  }

 private:
  double percentile(double part) {
    const auto place =
        samples_.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(samples_.size() - 1));
    std::nth_element(samples_.begin(), place, samples_.end());
    return *place;
  }

  const std::function<void()>& pause_;
  const double clock_cost_ = clock_cost();
  Clock::time_point block_begin_;
  std::vector<float> samples_;
  std::size_t count_ = 0;
};

/// False if the engine has no means for the experiment's world.
bool play(const EngineMaker& maker, const std::string& setting, Experiment& experiment, double step,
          Stopwatch& stopwatch) {
  const int steps = static_cast<int>(std::ceil(experiment.duration() / step - 1e-9));
  for (int trial = 0; trial < experiment.trials(); ++trial) {
    World world = experiment.world(trial);
    std::vector<Pose> now(world.kinematics.size()), next(world.kinematics.size());
    experiment.hand(trial, 0.0, now);
    for (std::size_t i = 0; i < now.size(); ++i) world.kinematics[i].pose = now[i];
    const auto engine = maker.make(setting, world, step);
    if (!engine) return false;
    for (int k = 1; k <= steps; ++k) {
      const double t = k * step;
      experiment.hand(trial, t, next);
      for (std::size_t i = 0; i < now.size(); ++i) engine->move(i, now[i], next[i]);
      engine->before_step();
      stopwatch.time(*engine);
      engine->after_step();
      now.swap(next);
      if (!experiment.observe(trial, t, *engine)) break;
    }
  }
  return true;
}

}  // namespace

RunResult run_experiment(const EngineMaker& maker, const std::string& setting, Experiment& experiment, double step,
                         const std::function<void()>& pause) {
  RunResult result;
  if (experiment.reference_step() > 0.0) {
    Stopwatch unused(pause);
    result.supported = play(maker, setting, experiment, experiment.reference_step(), unused);
    experiment.reference_done();
  }
  Stopwatch stopwatch(pause);
  result.supported = result.supported && play(maker, setting, experiment, step, stopwatch);
  result.time = stopwatch.result();
  if (result.supported) result.measures = experiment.measures();
  return result;
}

}  // namespace mrhi::benchmark
