#pragma once

#include <ros/node_handle.h>

#include <optional>
#include <string>

#include "mr_hand_interaction/training/session_folder.h"

namespace mrhi {

/// What the training node is told on the parameter server.
struct TrainingParameters {
  std::string task = "pick_and_place";  ///< ~task: name or YAML file
  SessionHeader header;       ///< ~participant, ~group, ~handedness, ~condition, ~seed, ~session, ~simulated
  std::optional<int> number;  ///< ~number: of the participant, from 1; else the one that ends the name
  std::string folder;         ///< ~folder: of the session; a ~ at its beginning is the home directory
  std::string simulation = "interaction_node";  ///< ~simulation: name of the node with the objects
  double auto_next = 3.0;   ///< ~auto_next: break after a trial [s]; below 0: the next one waits for ~next
  bool auto_start = false;  ///< ~auto_start: the first trial does not wait for ~next
};

/// Throws ParameterError naming a parameter that is unknown, missing or not allowed.
TrainingParameters read_training_parameters(const ros::NodeHandle& private_node);

}  // namespace mrhi
