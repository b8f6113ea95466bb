#pragma once

#include <interactive_markers/interactive_marker_server.h>
#include <ros/ros.h>

#include <map>
#include <memory>
#include <string>

#include "mr_hand_interaction/simulation.h"

namespace mrhi {

/// Interactive markers by which a free object is moved with the mouse in rviz, at ~place. Feedback comes by
/// the node's own queue of callbacks; what is dragged is asked for.
class Placing {
 public:
  Placing(const ros::NodeHandle& private_node, const std::string& fixed_frame);

  void turn(bool on, const Simulation& simulation);
  /// The bodies that there are have changed.
  void renew(const Simulation& simulation);
  /// Markers follow their bodies.
  void follow(const Simulation& simulation);
  /// Where the mouse holds objects. One that was let go, or of which nothing has been heard for a second, is
  /// no longer in it.
  std::map<std::string, Pose> dragged();

 private:
  struct Drag {
    Pose pose;
    ros::WallTime heard;
  };
  void take(const visualization_msgs::InteractiveMarkerFeedback& feedback);

  std::string topic_, fixed_frame_;
  std::unique_ptr<interactive_markers::InteractiveMarkerServer> server_;
  std::map<std::string, Drag> drags_;
};

}  // namespace mrhi
