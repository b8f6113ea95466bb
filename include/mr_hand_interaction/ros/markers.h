#pragma once

#include <std_msgs/Header.h>
#include <visualization_msgs/MarkerArray.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "mr_hand_interaction/simulation.h"

namespace mrhi {

class BodyMarkers;
class HandMarkers;
class Skin;

/// What rviz shows, a namespace for each layer: `hand` (rendered, as a skin), `ghost` (tracked, where it is
/// elsewhere), `capsules` (rendered, as simulated), `objects`, `fixtures`, `contacts` (points), `friction`
/// (rings), `forces` (arrows), `newtons` (the same in numbers), `share` (of friction's limit, a colour),
/// `shadows` and `text`. What passes (hands, contacts) is in each array, and deleted by the first one that it
/// is not in; what stays is sent when it changes, and again twice a second.
class Markers {
 public:
  Markers(const Scene& scene, const Configuration& configuration);  ///< keeps references
  Markers(const Scene& scene, const Configuration& configuration, const Skin& skin);
  ~Markers();

  /// `array` may be one that is done with: its memory is used again.
  void update(const FrameResult& result, const SimulationState& state, const std_msgs::Header& header,
              visualization_msgs::MarkerArray& array);
  /// What need not hurry, `capsules`, `shadows` and `text`: 30 times a second, after the picture. Empty in
  /// between.
  void update_rest(const FrameResult& result, const SimulationState& state, const std_msgs::Header& header,
                   visualization_msgs::MarkerArray& array);
  /// The next array has everything, and begins by deleting what was there before.
  void clear();
  /// The next array has everything.
  void send_all() { all_ = true; }

 private:
  /// Markers that are deleted when an array no longer has them.
  struct Passing {
    using Key = std::pair<std::string, int>;
    std::vector<Key> shown, now;  // in order
    void delete_gone(const std_msgs::Header& header, visualization_msgs::MarkerArray& array);
  };
  bool all_due(const ros::Time& stamp);

  const Scene& scene_;
  const Configuration& configuration_;
  const Vector3 text_place_;
  const double ground_;  ///< height of what shadows fall on
  std::unique_ptr<HandMarkers> hands_;
  std::unique_ptr<BodyMarkers> bodies_;
  std::string text_;
  Passing picture_, rest_;
  ros::Time all_sent_, rest_sent_;
  bool cleared_ = true, all_ = true, all_of_rest_ = true;
};

}  // namespace mrhi
