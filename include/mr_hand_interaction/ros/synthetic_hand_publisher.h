#pragma once

#include <ros/ros.h>
#include <topic_tools/shape_shifter.h>

#include <string>

#include "mr_hand_interaction/synthetic/synthetic_hand.h"

namespace mrhi {

/// Publishes a scripted hand on /leap_motion/leap_device as the Leap driver would, on a schedule of its own.
/// Parameters: ~motion (grasp_cube), ~side (right), ~rate (115) [Hz], ~noise (0), ~seed (1), ~loop (true),
/// ~reset: name of a std_srvs/Trigger service to call before each run but the first (none).
class SyntheticHandPublisher {
 public:
  /// Throws std::invalid_argument naming the parameter and what is allowed.
  SyntheticHandPublisher(ros::NodeHandle node, const ros::NodeHandle& parameters);

  /// Returns at shutdown, or after the first run if not looping. Begins once somebody listens, or after five
  /// seconds.
  void run();

 private:
  void wait_for_listener() const;
  void publish(JointsFrame frame, Nanoseconds start);
  void reset_scene();

  ros::NodeHandle node_;
  SyntheticHand hand_;
  float rate_;
  bool loop_;
  std::string reset_service_;
  ros::Publisher publisher_;
  topic_tools::ShapeShifter message_;
  std::uint32_t sequence_ = 0;
};

}  // namespace mrhi
