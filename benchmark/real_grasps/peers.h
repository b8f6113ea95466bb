#pragma once

#include "../speed_accuracy/engine.h"
#include "trial.h"

namespace mrhi::real_grasps {

/// In a physics engine: the hand that closes, filtered as ours is, as kinematic capsules; steps of
/// `configuration.step`.
Story play_peer(const std::vector<JointsFrame>& frames, const Closing& closing, const Row& row,
                const Configuration& configuration, const benchmark::EngineMaker& maker,
                const std::string& setting);

}  // namespace mrhi::real_grasps
