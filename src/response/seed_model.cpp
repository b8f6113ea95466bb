#include "seed_model.h"

namespace mrhi {

void SeedModel::respond(ContactStep& step) {
  islands_.build(step);
  impacts_.resolve(step, islands_, ImpactFriction::none);
  // A phalanx that is inside has had its approach, impact or not.
  for (Contact& contact : step.contacts) contact.struck = contact.struck || contact.depth > 0.0;
  penetration_phase(law_, step);
}

/// The paper's stiffness.
extern const ContactModelEntry seed_model{
    "seed", 1, 100.0, [](const ContactConfiguration& configuration) -> std::unique_ptr<ContactModel> {
      return std::make_unique<SeedModel>(penetration_law(configuration));
    }};

}  // namespace mrhi
