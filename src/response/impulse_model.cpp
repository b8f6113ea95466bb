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

}  // namespace mrhi
