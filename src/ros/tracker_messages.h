#pragma once

#include <string>
#include <tuple>
#include <vector>

#include "tracker_point_cloud.h"
#include "tracker_pose_array.h"

namespace mrhi {

/// Every message that trackers may give hands in besides the Leap's. Each has a struct with the type,
/// Message, how its topics end, kTopic, and what it says, read().
using TrackerMessages = std::tuple<PoseArrayTracker, PointCloudTracker>;

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
