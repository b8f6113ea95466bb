#pragma once

#include <string>
#include <vector>

#include "../speed_accuracy/engine.h"
#include "trial.h"

namespace mrhi::real_grasps {

/// A way to play closings: one of our models, or a physics engine, in one setting.
struct Contender {
  std::string engine, setting;
  Configuration configuration;  ///< ours; of a peer: filter, material and step
  Player player;
};

/// As configured, under the name of its model.
Contender ours(const Configuration& configuration);

/// Our models in several stiffnesses, the default first; all else as configured.
std::vector<Contender> our_settings(const Configuration& configuration);

/// All settings of an engine whose module (speed_accuracy_NAME.so) is loaded into this process: two of them
/// may not share one. Throws std::runtime_error.
std::vector<Contender> peer_settings(const std::string& module, const Configuration& configuration);

/// NAME of .../speed_accuracy_NAME.so.
std::string engine_name(const std::string& module);

/// In a physics engine: the hand that closes, filtered as ours is, as kinematic capsules; steps of
/// `configuration.step`.
Story play_peer(const std::vector<JointsFrame>& frames, const Closing& closing, const Row& row,
                const Configuration& configuration, const benchmark::EngineMaker& maker,
                const std::string& setting);

}  // namespace mrhi::real_grasps
