#pragma once

#include <mr_hand_interaction/HapticsArray.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>
#include <std_msgs/Header.h>

#include <cstdint>
#include <string>
#include <vector>

#include "mr_hand_interaction/ros/server_parameters.h"
#include "mr_hand_interaction/simulation.h"

namespace mrhi {

/// What every hand feels by `contacts` (sorted by key): an entry for each phalanx and object that touch or
/// strike.
mr_hand_interaction::HapticsArray haptics_message(const Scene& scene, const SimulationState& state,
                                                  const std::vector<Contact>& contacts,
                                                  const std_msgs::Header& header);

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

}  // namespace mrhi
