#pragma once

#include <mr_hand_interaction/HapticsArray.h>
#include <ros/ros.h>

#include <cstdint>
#include <string>
#include <vector>

#include "mr_hand_interaction/simulation.h"

namespace mrhi {

enum class HapticsRate : std::uint8_t { frame, step };

/// Publishes `haptics`, a message for each frame or each step, while somebody listens.
class HapticsPublisher {
 public:
  HapticsPublisher(ros::NodeHandle& node, HapticsRate rate);

  /// After each step: keeps what is felt, under the stamp of the step's end, until the frame is published.
  void note_step(const Simulation& simulation, Nanoseconds stamp);
  /// What the steps brought, or without any the frame itself, under its header.
  void publish(const Simulation& simulation, const FrameResult& result, const std_msgs::Header& header);

 private:
  HapticsRate rate_;
  ros::Publisher publisher_;
  std::vector<mr_hand_interaction::HapticsArrayPtr> steps_;
};

}  // namespace mrhi
