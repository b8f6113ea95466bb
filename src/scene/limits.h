#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>

#include "../text/yaml.h"
#include "mr_hand_interaction/scene/body.h"

/// What the numbers of a body may be: far beyond what hands meet, and so near that squares and quotients of
/// them are numbers still.
namespace mrhi::body_limits {

constexpr Range kMass{1e-6, 1e6};      ///< [kg]
constexpr Range kInertia{1e-18, 1e9};  ///< principal moments [kg m^2]
constexpr Range kSize{1e-5, 1000};     ///< of a shape, each [m]
constexpr Range kPlace{-1000, 1000};   ///< of a body, on each axis [m]
constexpr Range kSpeed{0, 100};        ///< [m/s]
constexpr Range kSpin{0, 1000};        ///< [rad/s]
constexpr Range kColor{0, 1};          ///< red, green, blue and opacity, each
constexpr Range kGravity{-100, 100};   ///< on each axis [m/s^2]

}  // namespace mrhi::body_limits

/// And those of a joint, in m, rad, N, N m and their quotients.
namespace mrhi::joint_ranges {

constexpr std::size_t kMostJoints = 256;
constexpr std::size_t kMostTogether = 32;  ///< that hang together: a step costs more than their square
constexpr std::size_t kMostDetents = 64;
constexpr double kLeastDetent = 1e-4;  // between two [rad], [m]
constexpr Range kCoordinate{-1000.0, 1000.0};
constexpr Range kForce{0.0, 1e5};
constexpr Range kStiffness{0.0, 1e6};
constexpr Range kRestitution{0.0, 1.0};
constexpr Range kAxis{1e-6, 1000.0};  ///< length of an axis as it is given
constexpr Range kReach{1e-5, 10.0};

}  // namespace mrhi::joint_ranges

namespace mrhi {

struct Joint;
struct Scene;

/// The joint by which a body hangs on another one; null if there is none.
const Joint* joint_of(const Scene& scene, int body);

/// One number of a material: its name in files, what it may be, and what a slider spans of that.
struct MaterialField {
  const char* name;
  const char* unit;
  double Material::*value;
  bool OwnMaterial::*own;
  Range range, slider;
};

/// All of them; both the scene's YAML and the parameters are read by this table.
const std::array<MaterialField, 4>& material_fields();

/// A velocity and a spin within body_limits. Throws InputError.
Twist read_twist(const YamlElement& element);

/// What is wrong with the numbers taken together, or nothing.
std::optional<std::string> material_conflict(const Material& material);

}  // namespace mrhi
