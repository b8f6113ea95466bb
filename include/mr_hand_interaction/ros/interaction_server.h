#pragma once

#include <ros/node_handle.h>

#include <cstdint>
#include <memory>
#include <string>

#include "mr_hand_interaction/ros/server_parameters.h"
#include "mr_hand_interaction/tracking/hand.h"

namespace mrhi {

/// Feeds hand_frame to a simulation and publishes what comes of it; takes changes of its scene and parameters
/// between frames. Callbacks of its node handles must not run at the same time.
class InteractionServer {
 public:
  /// Throws SceneError for a scene that cannot be loaded.
  InteractionServer(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
                    const ServerParameters& parameters);
  ~InteractionServer();

  /// Frames come from the topic hand_frame,
  void subscribe(ros::NodeHandle& node);
  /// or from the same process. `arrival`: of the message that they were in.
  void take(HandFrame frame, const std::string& frame_id, const ros::Time& arrival);
  /// Frames that have not arrived, where who hands them on knows.
  void note_lost(std::uint64_t frames);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mrhi
