#include "penetration_model.h"

#include "penetration_force.h"

namespace mrhi {

void PenetrationModel::respond(ContactStep& step) {
  penetration_phase(step);
}

/// The paper's stiffness.
extern const ContactModelEntry penetration_model{
    "penetration", 2, 100.0, [](const ContactConfiguration&) -> std::unique_ptr<ContactModel> {
      return std::make_unique<PenetrationModel>();
    }};

}  // namespace mrhi
