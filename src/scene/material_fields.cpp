#include "material_fields.h"

#include "../text/text.h"

namespace mrhi {

const std::array<MaterialField, 4>& material_fields() {
  static const std::array<MaterialField, 4> fields{{
      {"restitution", "", &Material::restitution, &OwnMaterial::restitution, {0, 1}, {0, 1}},
      {"static_friction", "", &Material::static_friction, &OwnMaterial::static_friction, {0, 10}, {0, 2}},
      {"dynamic_friction", "", &Material::dynamic_friction, &OwnMaterial::dynamic_friction, {0, 10}, {0, 2}},
      {"stiffness", " [N/m]", &Material::stiffness, &OwnMaterial::stiffness, {1, 1e7}, {10, 10000}},
  }};
  return fields;
}

std::optional<std::string> material_conflict(const Material& material) {
  if (material.dynamic_friction <= material.static_friction) return {};
  return "dynamic_friction " + text::number(material.dynamic_friction) + " is above static_friction " +
         text::number(material.static_friction) +
         "; allowed: at most static_friction, both set at once if need be";
}

}  // namespace mrhi
