#include "impulse_model.h"

namespace mrhi {

void ImpulseModel::respond(ContactStep& step) {
  for (Contact& contact : step.contacts) {
    contact.force.setZero();
    contact.struck = false;
  }
  impacts_.resolve(step, ImpactFriction::none);
}

}  // namespace mrhi
