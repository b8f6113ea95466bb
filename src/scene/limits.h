#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>

#include "../text/yaml.h"
#include "mr_hand_interaction/scene/body.h"

/// Limits of a body's numbers: far beyond what hands meet, but small enough that their squares and quotients
/// are finite.
namespace mrhi::body_limits {

constexpr Range kMass{1e-6, 1e6};      ///< [kg]
constexpr Range kInertia{1e-18, 1e9};  ///< principal moments [kg m^2]
constexpr Range kSize{1e-5, 1000};     ///< of a shape, each [m]
constexpr Range kPlace{-1000, 1000};   ///< of a body, on each axis [m]
constexpr Range kSpeed{0, 100};        ///< [m/s]
constexpr Range kSpin{0, 1000};        ///< [rad/s]
constexpr Range kColor{0, 1};          ///< red, green, blue and opacity, each
constexpr Range kGravity{-100, 100};   ///< on each axis [m/s^2]
constexpr int kMaxOperators = 4;       ///< of a scene: one for each hand

}  // namespace mrhi::body_limits

/// Limits of a joint's numbers, in m, rad, N, N m and their quotients.
namespace mrhi::joint_ranges {

constexpr std::size_t kMaxJoints = 256;
constexpr std::size_t kMaxConnectedJoints =
    32;  ///< in a mechanism: the cost of a step grows faster than their square
constexpr std::size_t kMaxDetents = 64;
constexpr double kMinDetentDistance = 1e-4;  ///< smallest distance between two [rad], [m]
constexpr Range kCoordinate{-1000.0, 1000.0};
constexpr Range kForce{0.0, 1e5};
constexpr Range kStiffness{0.0, 1e6};
constexpr Range kRestitution{0.0, 1.0};
constexpr Range kAxis{1e-6, 1000.0};  ///< length of an axis in a URDF
constexpr Range kLatchReach{1e-5, 10.0};

}  // namespace mrhi::joint_ranges

namespace mrhi {

struct Joint;
struct Scene;

/// The joint that connects a body to its parent; null if there is none.
const Joint* joint_of(const Scene& scene, int body);

/// One number of a material: its name in files, its limits, and those of its slider.
struct MaterialField {
  const char* name;
  const char* unit;
  double Material::*value;
  bool OwnMaterial::*own;
  Range range, slider;
};

/// All numbers of a material. The scene's YAML and the parameters are read by this table.
const std::array<MaterialField, 4>& material_fields();

/// Reads a velocity and a spin within body_limits. Throws InputError.
Twist read_twist(const YamlElement& element);

/// A conflict between the numbers; empty if there is none.
std::optional<std::string> material_conflict(const Material& material);

}  // namespace mrhi
