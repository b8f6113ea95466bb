#pragma once

#include <functional>

#include "experiment.h"

namespace mrhi::benchmark {

/// Duration of a step.
struct StepTime {
  double median = 0.0;  ///< [us], like all
  double percentile_99 = 0.0;
  double mean = 0.0;  ///< of all steps, like the next: processor time, unaffected by other load
  double most = 0.0;
};

struct RunResult {
  bool supported = true;  ///< false: the engine does not support this world
  StepTime time;
  std::vector<Measure> measures;
  std::string trouble;  ///< reason why the run was aborted, or empty; its measures have failed then
};

/// Runs an experiment in an engine and times every step. `pause` is called between blocks of some
/// milliseconds, so that runs of several engines can alternate. A run longer than `seconds` is aborted.
RunResult run_experiment(const EngineMaker& maker, const std::string& setting, Experiment& experiment,
                         double step, double seconds, const std::function<void()>& pause);

}  // namespace mrhi::benchmark
