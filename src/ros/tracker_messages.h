#pragma once

#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "tracker_list.h"

namespace mrhi {

// TrackerMessages is every message that trackers may give hands in. Each has a file, tracker_NAME.h, with a
// struct NAMETracker: the message's type, kType, and its versions, md5s(); the topics where it is looked for;
// and what it says, read(). The build finds it.

/// Calls `use` with one of each.
template <class Use>
void for_each_tracker(Use use) {
  std::apply([&use](auto... tracker) { (use(tracker), ...); }, TrackerMessages());
}

}  // namespace mrhi
