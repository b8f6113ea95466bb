#include "impulse_model.h"

#include "mr_hand_interaction/response/impact.h"

namespace mrhi {

void ImpulseModel::respond(ContactStep& step) const {
  for (Contact& contact : step.contacts) {
    contact.force.setZero();
    contact.struck = false;
  }
  impulse_phase(step, ImpactFriction::none);
}

}  // namespace mrhi
