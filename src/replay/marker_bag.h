#pragma once

#include <memory>
#include <set>
#include <string>

#include "mr_hand_interaction/simulation.h"

namespace mrhi {

/// A bag with what viewers show. Either of chosen frames: for each its number on /frame (std_msgs/UInt32),
/// then its markers on /markers (visualization_msgs/MarkerArray), with all that is there. Or of a whole run:
/// /markers at a rate, as a live node sends them, and for every frame /scene (when it changes),
/// /rendered_hands, /tracked_hands, /objects and /contacts.
class MarkerBag {
 public:
  /// `frames`: their numbers, from 0. Throws UsageError where this was built without ROS.
  MarkerBag(const std::string& file, const std::set<std::size_t>& frames);
  MarkerBag(const std::string& file, double rate);  ///< [Hz]
  ~MarkerBag();
  /// After each frame; the first makes the file. Throws std::runtime_error naming it if it cannot be written.
  void watch(const Simulation& simulation);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mrhi
