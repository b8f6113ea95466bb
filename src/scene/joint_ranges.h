#pragma once

#include <cstddef>

#include "../text/yaml_values.h"

namespace mrhi::joint_ranges {

constexpr std::size_t kMostJoints = 256;
constexpr std::size_t kMostDetents = 64;
constexpr double kLeastDetent = 1e-4;  // between two [rad], [m]
constexpr Range kPlace{-1000.0, 1000.0};
constexpr Range kForce{0.0, 1e5};
constexpr Range kStiffness{0.0, 1e6};
constexpr Range kRestitution{0.0, 1.0};
constexpr Range kReach{1e-5, 10.0};

}  // namespace mrhi::joint_ranges
