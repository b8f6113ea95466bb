#pragma once

#include <memory>
#include <set>
#include <string>

#include "mr_hand_interaction/simulation.h"

namespace mrhi {

/// A bag with what rviz shows of chosen frames: for each its number on /frame (std_msgs/UInt32), then its
/// markers on /markers (visualization_msgs/MarkerArray).
class MarkerBag {
 public:
  /// `frames`: their numbers, from 0. Throws UsageError where this was built without ROS.
  MarkerBag(const std::string& file, const std::set<std::size_t>& frames);
  ~MarkerBag();
  /// After each frame; the first makes the file. Throws std::runtime_error naming it if it cannot be written.
  void watch(const Simulation& simulation);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mrhi
