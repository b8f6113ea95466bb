#pragma once

#include <array>
#include <optional>
#include <string>

#include "../text/yaml_values.h"
#include "mr_hand_interaction/scene/material.h"

namespace mrhi {

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

/// What is wrong with the numbers taken together, or nothing.
std::optional<std::string> material_conflict(const Material& material);

}  // namespace mrhi
