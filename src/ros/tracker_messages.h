#pragma once

#include <string>
#include <tuple>
#include <vector>

#include "tracker_list.h"

namespace mrhi {

// TrackerMessages is every message that trackers may give hands in besides the Leap's. Each has a file,
// tracker_NAME.h, with a struct NAMETracker: the type, Message, how its topics end, kTopic, and what it says,
// read(). The build finds it.

/// Calls `use` with one of each.
template <class Use>
void for_each_tracker(Use use) {
  std::apply([&use](auto... tracker) { (use(tracker), ...); }, TrackerMessages());
}

/// One hand or both, the left hand, the right.
template <class Tracker>
std::vector<std::string> topics_of(const Tracker&) {
  const std::string end = Tracker::kTopic;
  return {"hands/" + end, "hands/left/" + end, "hands/right/" + end};
}

}  // namespace mrhi
