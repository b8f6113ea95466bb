#pragma once

#include <mr_hand_interaction/HandFrame.h>
#include <ros/ros.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>
#include <tf2_ros/transform_broadcaster.h>

#include <string>

#include "mr_hand_interaction/ros/haptics_publisher.h"
#include "mr_hand_interaction/ros/interaction_diagnostics.h"
#include "mr_hand_interaction/ros/markers.h"
#include "mr_hand_interaction/ros/server_parameters.h"
#include "mr_hand_interaction/ros/stamp_clock.h"
#include "mr_hand_interaction/simulation.h"

namespace mrhi {

/// Feeds hand_frame to a simulation and publishes what comes of it. One thread.
class InteractionServer {
 public:
  /// Throws SceneError for a scene that cannot be loaded.
  InteractionServer(ros::NodeHandle node, ros::NodeHandle private_node, const ServerParameters& parameters);

 private:
  void take(const mr_hand_interaction::HandFrame& message);
  bool begin(const mr_hand_interaction::HandFrame& message);
  bool timed_step();
  void idle();

  bool reset(std_srvs::Trigger::Response& response);
  bool pause(bool paused, std_srvs::SetBool::Response& response);

  /// All that a result holds, under its own stamp; and what may be shown again at any time.
  void publish(const FrameResult& result);
  void publish_scene(const FrameResult& result, const ros::Time& stamp);
  void publish_markers(const FrameResult& result, const std_msgs::Header& header);

  std::string fixed_frame_;
  Simulation simulation_;
  StampClock clock_;
  Markers markers_;
  InteractionDiagnostics diagnostics_;
  HapticsPublisher haptics_;
  ros::WallTime published_, markers_published_;
  ros::Time transforms_stamp_;

  ros::Publisher rendered_hands_, objects_, contacts_, events_, marker_publisher_;
  tf2_ros::TransformBroadcaster transforms_;
  ros::Subscriber hands_;
  ros::ServiceServer reset_, pause_;
  ros::WallTimer idle_timer_;
};

}  // namespace mrhi
