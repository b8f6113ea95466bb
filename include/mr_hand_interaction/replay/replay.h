#pragma once

#include <functional>

#include "mr_hand_interaction/replay/arguments.h"
#include "mr_hand_interaction/replay/frame_source.h"
#include "mr_hand_interaction/replay/progress_bar.h"
#include "mr_hand_interaction/replay/result_writer.h"
#include "mr_hand_interaction/replay/summary.h"
#include "mr_hand_interaction/simulation.h"

namespace mrhi {

/// Scene and parameters as the arguments say, objects placed. Throws UsageError for a name or value on the
/// command line that is not allowed, SceneError and ParameterError for files.
Simulation prepare_simulation(const ReplayArguments& arguments);

/// Who looks at each result.
using FrameWatcher = std::function<void(const Simulation&)>;

/// Runs all frames through the simulation; each result is written. The summary grows as it goes on, so that
/// it holds if this throws.
void run_frames(FrameSource& source, Simulation& simulation, ResultWriter& writer, ProgressBar& progress,
                ReplaySummary& summary, const FrameWatcher& watcher = {});

/// The whole program after its arguments are known. Throws UsageError, else std::exception with one line for
/// bad data; what had been written stays.
void replay(const ReplayArguments& arguments);

}  // namespace mrhi
