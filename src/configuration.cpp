#include "mr_hand_interaction/configuration.h"

#include "response/soft_pad_model.h"
#include "response/virtual_spring_model.h"

namespace mrhi {
namespace {

double own_stiffness(ContactModelKind model) {
  switch (model) {
    case ContactModelKind::implicit:
      return 2000.0;
    case ContactModelKind::virtual_spring:
      return VirtualSpringModel::kStiffness;
    case ContactModelKind::soft_pad:
      return SoftPadModel::kStiffness;
    case ContactModelKind::seed:
    case ContactModelKind::penetration:
    case ContactModelKind::impulse:
      break;
  }
  return 100.0;
}

}  // namespace

Material default_material(const Configuration& configuration) {
  Material material = configuration.material;
  material.stiffness = configuration.stiffness.value_or(own_stiffness(configuration.contact_model));
  return material;
}

}  // namespace mrhi
