#include "penetration_model.h"

#include "mr_hand_interaction/response/penetration_force.h"

namespace mrhi {

void PenetrationModel::respond(ContactStep& step) {
  penetration_phase(step);
}

}  // namespace mrhi
