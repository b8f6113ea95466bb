#pragma once

#include <memory>
#include <string>

#include "../record/log.h"
#include "frame_source.h"
#include "mr_hand_interaction/replay/replay.h"

namespace mrhi {

/// A recording that is open, and the topic that is read of it.
struct ReplayInput {
  std::unique_ptr<FrameSource> frames;
  std::string topic;
};

/// Throws BagError; where this was built without ROS, UsageError.
ReplayInput open_bag(const ReplayArguments& arguments);

/// The log of a live simulation, if the recording has one; else why not.
struct OpenLog {
  std::unique_ptr<LogSource> source;
  std::string topic, why_not;
};

/// Throws BagError.
OpenLog open_log(const ReplayArguments& arguments);

}  // namespace mrhi
