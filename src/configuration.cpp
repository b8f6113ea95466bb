#include "mr_hand_interaction/configuration.h"

namespace mrhi {

Material default_material(const Configuration& configuration) {
  Material material = configuration.material;
  const bool implicit = configuration.contact_model == ContactModelKind::implicit;
  material.stiffness = configuration.stiffness.value_or(implicit ? 2000.0 : 100.0);
  return material;
}

}  // namespace mrhi
