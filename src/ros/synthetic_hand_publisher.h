#pragma once

#include <ros/ros.h>

#include <string>

#include "leap_human_publisher.h"
#include "mr_hand_interaction/synthetic/synthetic_hand.h"

namespace mrhi {

/// The motion of that name; grasp_object's is made for the scene, a name or a URDF's path. Throws
/// std::invalid_argument, or SceneError.
ScriptedMotion motion_for(const std::string& motion, const std::string& scene);

/// Publishes a scripted hand on /leap_motion/leap_device as the Leap driver would, on a schedule of its own.
/// Parameters: ~motion (grasp_cube), ~scene (of the motion grasp_object), ~side (right), ~rate (115) [Hz],
/// ~noise (0), ~seed (1), ~loop (true), ~reset: name of a std_srvs/Trigger service to call before each run
/// but the first (none).
class SyntheticHandPublisher {
 public:
  /// Throws std::invalid_argument naming the parameter and what is allowed.
  SyntheticHandPublisher(ros::NodeHandle node, const ros::NodeHandle& parameters);

  /// Returns at shutdown, or after the first run if not looping. Begins once somebody listens, or after five
  /// seconds.
  void run();

 private:
  void wait_for_listener() const;
  void wait_for_next();
  void reset_scene();

  ros::NodeHandle node_;
  SyntheticHand hand_;
  bool loop_;
  Nanoseconds start_ = 0, looked_ = 0;  // ROS time of the first run, and of the last look at the clock
  std::string reset_service_;
  LeapHumanPublisher publisher_;
};

}  // namespace mrhi
