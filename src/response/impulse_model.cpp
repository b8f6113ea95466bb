#include "impulse_model.h"

namespace mrhi {

void ImpulseModel::respond(ContactStep& step) {
  for (Contact& contact : step.contacts) {
    contact.force.setZero();
    contact.struck = false;
  }
  islands_.build(step);
  impacts_.resolve(step, islands_, ImpactFriction::none);
}

/// The paper's stiffness.
extern const ContactModelEntry impulse_model{
    "impulse", 3, 100.0, [](const ContactConfiguration&) -> std::unique_ptr<ContactModel> {
      return std::make_unique<ImpulseModel>();
    }};

}  // namespace mrhi
