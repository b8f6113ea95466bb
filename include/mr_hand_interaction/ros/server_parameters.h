#pragma once

#include <ros/node_handle.h>

#include <cstdint>
#include <map>
#include <string>

#include "mr_hand_interaction/configuration.h"
#include "mr_hand_interaction/math.h"

namespace mrhi {

enum class HapticsRate : std::uint8_t { frame, step };

/// Parameters of the interaction node on the parameter server.
struct ServerParameters {
  std::string scene = "cube";                  ///< ~scene: name or URDF file
  std::string fixed_frame = "world";           ///< ~fixed_frame
  std::map<std::string, Twist> object_twists;  ///< ~object_twist/NAME: [vx, vy, vz, wx, wy, wz] at the start
  HapticsRate haptics_rate = HapticsRate::frame;  ///< ~haptics/rate: one message per frame or per step
  bool place_by_mouse = false;    ///< ~place_by_mouse: interactive markers that move the objects
  bool standard_outputs = false;  ///< ~standard_outputs: standard messages too
  Configuration configuration;    ///< every name of parameters.h
};

/// Reads the private parameters of a node. Throws ParameterError with the first that is unknown or invalid.
ServerParameters read_server_parameters(const ros::NodeHandle& private_node);

/// A value of the parameter server as YAML text; strings are unchanged.
std::string yaml_text(XmlRpc::XmlRpcValue value);

}  // namespace mrhi
