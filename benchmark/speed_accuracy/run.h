#pragma once

#include <functional>

#include "experiment.h"

namespace mrhi::benchmark {

/// How long a step took.
struct StepTime {
  double median = 0.0;  ///< [us], as all
  double percentile_99 = 0.0;
  double mean =
      0.0;  ///< of all steps, as the next: the processor's time, which others on the machine do not count in
  double most = 0.0;
};

struct RunResult {
  bool supported = true;  ///< false: the engine has no means for this world
  StepTime time;
  std::vector<Measure> measures;
  std::string trouble;  ///< why the run was broken off, or empty; its measures have failed then
};

/// Plays an experiment in an engine and times every step. `pause` is called between blocks of some
/// milliseconds, so that runs of several engines can take turns. A run that takes longer than `seconds` is
/// broken off.
RunResult run_experiment(const EngineMaker& maker, const std::string& setting, Experiment& experiment,
                         double step, double seconds, const std::function<void()>& pause);

}  // namespace mrhi::benchmark
