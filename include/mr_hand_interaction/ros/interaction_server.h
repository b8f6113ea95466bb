#pragma once

#include <ros/node_handle.h>

#include <cstdint>
#include <memory>
#include <string>

#include "mr_hand_interaction/ros/server_parameters.h"
#include "mr_hand_interaction/tracking/hand.h"

namespace mrhi {

/// Runs a simulation on hand_frame and publishes its results. Changes of its scene and parameters are applied
/// between frames. Callbacks of its node handles must not run concurrently.
class InteractionServer {
 public:
  /// Throws SceneError for a scene that cannot be loaded.
  InteractionServer(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
                    const ServerParameters& parameters);
  ~InteractionServer();

  /// Receives frames from the topic hand_frame,
  void subscribe(ros::NodeHandle& node);
  /// or from the same process. `arrival`: time at which the frame's message arrived.
  void take(HandFrame frame, const std::string& frame_id, const ros::Time& arrival);
  /// Number of frames that have not arrived, if the sender knows it.
  void note_lost(std::uint64_t frames);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mrhi
