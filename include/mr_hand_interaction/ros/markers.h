#pragma once

#include <std_msgs/Header.h>
#include <visualization_msgs/MarkerArray.h>

#include <memory>
#include <set>
#include <string>
#include <utility>

#include "mr_hand_interaction/simulation.h"

namespace mrhi {

class HandMarkers;

/// What rviz shows, a namespace for each layer: `hand` (rendered, as a skin), `ghost` (tracked, where it is
/// elsewhere), `capsules` (rendered, as simulated), `objects`, `fixtures`, `contacts` (points), `friction`
/// (rings), `forces` (arrows) and `text`. An array replaces the one before: what is in it no longer is
/// deleted.
class Markers {
 public:
  Markers(const Scene& scene, const Configuration& configuration);  ///< keeps references
  ~Markers();

  visualization_msgs::MarkerArray update(const FrameResult& result, const SimulationState& state,
                                         const std_msgs::Header& header);
  /// The next array begins by deleting everything.
  void clear() { shown_.clear(), cleared_ = true; }

 private:
  void delete_stale(const std_msgs::Header& header, visualization_msgs::MarkerArray& array);

  const Scene& scene_;
  const Configuration& configuration_;
  const Vector3 text_place_;
  std::unique_ptr<HandMarkers> hands_;
  std::set<std::pair<std::string, int>> shown_;
  bool cleared_ = true;
};

}  // namespace mrhi
