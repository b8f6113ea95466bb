#pragma once

#include <geometry_msgs/PoseArray.h>
#include <geometry_msgs/Wrench.h>
#include <ros/ros.h>
#include <std_msgs/Header.h>

#include <array>
#include <map>
#include <optional>
#include <string>

#include "mr_hand_interaction/simulation.h"

namespace mrhi {

/// 21 joints in the order of ros/tracked_points.h, each with x along the bone that ends or, of wrist and
/// knuckles, begins there; a joint that the hand has not is NaN.
geometry_msgs::PoseArray pose_array_message(const Hand& hand, const std_msgs::Header& header);

/// What hands do to a body: the sum of the contacts' forces, and their torque about the centre of mass, in
/// world axes [N, N m]. Blows (impulses) are not in it.
geometry_msgs::Wrench wrench_message(std::size_t body, const FrameResult& result,
                                     const SimulationState& state);

/// The names of what is held, in the scene's order, with commas between them.
std::string held_objects(const Scene& scene, const SimulationState& state);

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

}  // namespace mrhi
