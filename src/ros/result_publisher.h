#pragma once

#include <ros/ros.h>
#include <tf2_ros/transform_broadcaster.h>

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "input_log.h"
#include "mr_hand_interaction/ros/markers.h"
#include "mr_hand_interaction/ros/server_parameters.h"
#include "mr_hand_interaction/simulation.h"
#include "result_messages.h"

namespace mrhi {

/// Publishes `haptics`, and `haptics/joints` (what each joint of the scene does by itself, as effort) where
/// there are any, a message for each frame or each step, while somebody listens.
class HapticsPublisher {
 public:
  HapticsPublisher(ros::NodeHandle& node, HapticsRate rate);

  /// After each step: keeps what is felt, under the stamp of the step's end, until the frame is published.
  void note_step(const Simulation& simulation, Nanoseconds stamp);
  /// What the steps brought, or without any the frame itself, under its header.
  void publish(const Simulation& simulation, const FrameResult& result, const std_msgs::Header& header);

 private:
  void add(const Simulation& simulation, const std::vector<Contact>& contacts,
           const std_msgs::Header& header);

  HapticsRate rate_;
  ros::Publisher publisher_, joint_publisher_;
  std::vector<mr_hand_interaction::HapticsArrayPtr> steps_;
  std::vector<sensor_msgs::JointStatePtr> joint_steps_;
};

/// The results as messages that everybody has, for those who do not have this package's:
///   objects/NAME/pose (PoseStamped) and objects/NAME/wrench (WrenchStamped) of each free body; a topic has
///   no
///     -, which becomes _, and ends in one _ more for each topic of that name that there is already;
///   held_object (String), latched and when it changes;
///   rendered_hands/left/pose_array and rendered_hands/right/pose_array (PoseArray).
class StandardOutputs {
 public:
  explicit StandardOutputs(const ros::NodeHandle& node);

  /// Of objects.
  void publish(const Scene& scene, const FrameResult& result, const SimulationState& state,
               const std_msgs::Header& header);
  void publish_hands(const FrameResult& result, const std_msgs::Header& header);
  /// Poses and what is held, as publish does.
  void publish_objects(const Scene& scene, const SimulationState& state, const std_msgs::Header& header);

 private:
  struct ObjectTopics {
    std::string name;  // without /pose and /wrench
    ros::Publisher pose, wrench;
  };
  ObjectTopics new_topics(const std::string& body, const std::map<std::string, ObjectTopics>& there);
  void follow(const Scene& scene);

  ros::NodeHandle node_;
  std::map<std::string, ObjectTopics> objects_;
  std::array<ros::Publisher, 2> hands_;  // by side
  ros::Publisher held_;
  std::optional<std::string> last_held_;
};

/// Publishes what comes of a simulation, and only where somebody listens.
class ResultPublisher {
 public:
  ResultPublisher(ros::NodeHandle node, const std::string& fixed_frame, HapticsRate haptics,
                  const StampClock& clock);
  /// From now on the standard messages of StandardOutputs too.
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
