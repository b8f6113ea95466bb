#pragma once

#include <mr_hand_interaction/SceneDescription.h>
#include <ros/ros.h>
#include <std_msgs/Header.h>
#include <tf2_ros/transform_broadcaster.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "haptics_publisher.h"
#include "mr_hand_interaction/ros/markers.h"
#include "mr_hand_interaction/simulation.h"
#include "stamp_clock.h"
#include "standard_outputs.h"

namespace mrhi {

/// Publishes what comes of a simulation, and only where somebody listens.
class ResultPublisher {
 public:
  ResultPublisher(ros::NodeHandle node, const std::string& fixed_frame, HapticsRate haptics,
                  const StampClock& clock);
  /// From now on those of standard_outputs.h too.
  void add_standard_outputs(const ros::NodeHandle& node);

  /// From now on this one. rviz begins with an empty picture, so that what is no longer there goes.
  void show(const Simulation& simulation);
  /// After each step of a frame.
  void note_step();
  /// What robots and gloves wait for, under the result's own stamp: haptics, contacts, objects. Its rendered
  /// hands are not looked at.
  void publish_response(const FrameResult& result);
  /// What eyes wait for: hands, then transforms, events and, at most kMarkerRate times a second, markers.
  void publish_picture(const FrameResult& result);
  /// Both.
  void publish(const FrameResult& result);
  /// What may be shown again at any time: hands and contacts as they were, markers, objects, transforms.
  void publish_scene(const FrameResult& result, const ros::Time& stamp);
  void publish_events(const std::vector<Event>& events);

  /// When something was last shown.
  ros::WallTime shown() const { return shown_; }
  static constexpr double kMarkerRate = 60.0;  ///< [Hz]

 private:
  std_msgs::Header header(const ros::Time& stamp) const;
  std_msgs::Header header(const FrameResult& result) const;
  void publish_scene_description();
  void publish_hands(const FrameResult& result, const std_msgs::Header& header);
  void publish_markers(const FrameResult& result, const std_msgs::Header& header);
  void publish_contacts(const FrameResult& result, const std_msgs::Header& header);
  void publish_objects(const std_msgs::Header& header);
  void publish_transforms(const std_msgs::Header& header);

  std::string fixed_frame_;
  const StampClock& clock_;
  const Simulation* simulation_ = nullptr;
  std::unique_ptr<Markers> markers_;
  HapticsPublisher haptics_;
  std::optional<StandardOutputs> standard_;
  ros::Publisher rendered_hands_, tracked_hands_, objects_, joint_states_, contacts_, events_,
      marker_publisher_, scene_publisher_;
  bool scene_changed_ = false;
  visualization_msgs::MarkerArray::Ptr picture_;  // the last one
  tf2_ros::TransformBroadcaster transforms_;
  ros::Time transforms_stamp_;
  ros::WallTime shown_, markers_shown_;
};

}  // namespace mrhi
