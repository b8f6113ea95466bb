#include "run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <limits>
#include <stdexcept>

namespace mrhi::benchmark {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kBlock = 4e-3;               // [s]
constexpr std::size_t kMaxSamples = 400'000;  // of step times; later ones replace the oldest

double microseconds(Clock::duration duration) {
  return std::chrono::duration<double, std::micro>(duration).count();
}

/// Processor time of this thread [us].
double processor_time() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

/// Cost of two clock readings.
template <typename Between>
double clock_cost(Between between) {
  std::vector<double> costs;
  for (int i = 0; i < 1001; ++i) costs.push_back(between());
  std::nth_element(costs.begin(), costs.begin() + 500, costs.end());
  return costs[500];
}

class Stopwatch {
 public:
  /// `seconds`: of processor time, so that other programs do not make an engine too slow.
  Stopwatch(double seconds, const std::function<void()>& pause) : seconds_(seconds), pause_(pause) {
    samples_.reserve(kMaxSamples);
    begin_block();
  }

  void begin_block() {
    block_begin_ = Clock::now();
    used_before_ = processor_time();
  }

  void time(Engine& engine) {
    const double before = processor_time();
    const auto begin = Clock::now();
    engine.step();
    const auto end = Clock::now();
    const double used = std::max(0.0, processor_time() - before - processor_cost_);
    sum_ += used;
    most_ = std::max(most_, used);
    const auto sample = static_cast<float>(std::max(0.0, microseconds(end - begin) - clock_cost_));
    if (samples_.size() < kMaxSamples) {
      samples_.push_back(sample);
    } else {
      samples_[count_ % kMaxSamples] = sample;
    }
    ++count_;
    if (microseconds(end - block_begin_) < 1e6 * kBlock) return;
    used_ += 1e-6 * (processor_time() - used_before_);
    if (used_ > seconds_) throw std::runtime_error("too slow");
    pause_();
    begin_block();
  }

  StepTime result() {
    if (samples_.empty()) return {};
    return {percentile(0.5), percentile(0.99), sum_ / static_cast<double>(count_), most_};
  }

 private:
  double percentile(double part) {
    const auto place =
        samples_.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(samples_.size() - 1));
    std::nth_element(samples_.begin(), place, samples_.end());
    return *place;
  }

  double seconds_, used_ = 0.0;
  double sum_ = 0.0, most_ = 0.0;  // [us]
  const std::function<void()>& pause_;
  const double clock_cost_ = clock_cost([] {
    const auto begin = Clock::now();
    return microseconds(Clock::now() - begin);
  });
  const double processor_cost_ = clock_cost([] {
    const double before = processor_time();
    Clock::now(), Clock::now();
    return processor_time() - before;
  });
  Clock::time_point block_begin_;
  double used_before_ = 0.0;  // [us]
  std::vector<float> samples_;
  std::size_t count_ = 0;
};

/// Returns false if the engine does not support the experiment's world.
bool play(const EngineMaker& maker, const std::string& setting, Experiment& experiment, double step,
          Stopwatch& stopwatch) {
  stopwatch.begin_block();
  const int steps = static_cast<int>(std::ceil(experiment.duration() / step - 1e-9));
  for (int trial = 0; trial < experiment.trials(); ++trial) {
    World world = experiment.world(trial);
    std::vector<Pose> now(world.kinematics.size()), next(world.kinematics.size());
    experiment.hand(trial, 0.0, now);
    for (std::size_t i = 0; i < now.size(); ++i) world.kinematics[i].pose = now[i];
    const auto engine = maker.make(setting, world, step);
    if (!engine) return false;
    if (experiment.watches_forces()) engine->watch_forces();
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

RunResult run_experiment(const EngineMaker& maker, const std::string& setting, Experiment& experiment,
                         double step, double seconds, const std::function<void()>& pause) {
  RunResult result;
  Stopwatch stopwatch(seconds, pause);
  try {
    if (experiment.reference_step() > 0.0) {
      Stopwatch unused(10.0 * seconds, pause);
      result.supported = play(maker, setting, experiment, experiment.reference_step(), unused);
      experiment.reference_done();
    }
    result.supported = result.supported && play(maker, setting, experiment, step, stopwatch);
  } catch (const std::exception& error) {
    result.trouble = error.what();
  }
  result.time = stopwatch.result();
  if (!result.supported) return result;
  result.measures = experiment.measures();
  for (Measure& measure : result.measures) {
    if (!result.trouble.empty()) measure.error = std::numeric_limits<double>::quiet_NaN();
    measure.failed = measure.failed || !std::isfinite(measure.error);
  }
  return result;
}

}  // namespace mrhi::benchmark
