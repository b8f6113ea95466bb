#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <mr_hand_interaction/HandFrame.h>
#include <ros/ros.h>

#include <string>
#include <vector>

#include "input_statistics.h"
#include "mr_hand_interaction/tracking/hand_merger.h"

namespace mrhi {

/// Merges the hand_frame topics of several hand_tracking_nodes into one. Parameters: ~inputs, the topics;
/// ~mode: people (default) or fused. Throws std::invalid_argument for a bad one.
class HandMerging {
 public:
  HandMerging(ros::NodeHandle node, const ros::NodeHandle& parameters);

 private:
  void take(std::size_t stream, const mr_hand_interaction::HandFrame& message);

  std::vector<std::string> inputs_;
  HandMerger merger_;
  std::string frame_id_;  // of the first frame; all must have it
  InputStatistics statistics_;
  ros::Publisher publisher_;
  std::vector<ros::Subscriber> subscribers_;
  diagnostic_updater::Updater diagnostics_;
  ros::WallTimer timer_;
};

}  // namespace mrhi
