#pragma once

#include <string>
#include <vector>

#include "../speed_accuracy/engine.h"
#include "trial.h"

namespace mrhi::real_grasps {

/// A player of closings: one of our models, or a physics engine, in one setting.
struct Contender {
  std::string engine, setting;
  Configuration configuration;  ///< ours; of a peer: filter, material and step
  Player player;
};

/// Our model as configured, under its name.
Contender ours(const Configuration& configuration);

/// Our models with several stiffnesses, the default first; all else as configured.
std::vector<Contender> our_settings(const Configuration& configuration);

/// All settings of an engine whose module (speed_accuracy_NAME.so) is loaded into this process, which can
/// hold only one. Throws std::runtime_error.
std::vector<Contender> peer_settings(const std::string& module, const Configuration& configuration);

/// NAME of .../speed_accuracy_NAME.so.
std::string engine_name(const std::string& module);

/// Plays in a physics engine: the closing hand, with our filter, as kinematic capsules; steps of
/// `configuration.step`.
Playback play_peer(const std::vector<JointsFrame>& frames, const Closing& closing, const Row& row,
                   const Configuration& configuration, const benchmark::EngineMaker& maker,
                   const std::string& setting);

}  // namespace mrhi::real_grasps
