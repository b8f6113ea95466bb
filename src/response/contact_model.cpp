#include "mr_hand_interaction/response/contact_model.h"

#include "implicit_model.h"
#include "impulse_model.h"
#include "penetration_model.h"
#include "seed_model.h"
#include "soft_pad_model.h"
#include "virtual_spring_model.h"

namespace mrhi {

std::unique_ptr<const ContactModel> make_contact_model(const Configuration& configuration) {
  switch (configuration.contact_model) {
    case ContactModelKind::penetration:
      return std::make_unique<PenetrationModel>();
    case ContactModelKind::impulse:
      return std::make_unique<ImpulseModel>();
    case ContactModelKind::implicit:
      return std::make_unique<ImplicitModel>(configuration.contact.torsion);
    case ContactModelKind::virtual_spring:
      return std::make_unique<VirtualSpringModel>();
    case ContactModelKind::soft_pad:
      return std::make_unique<SoftPadModel>();
    case ContactModelKind::seed:
      break;
  }
  return std::make_unique<SeedModel>();
}

}  // namespace mrhi
