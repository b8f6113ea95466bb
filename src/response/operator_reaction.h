#pragma once

#include "contact_step.h"

namespace mrhi {

/// True if all that changes a body's momenta in the response is the hands of the only operator, from the
/// step's start on: the operator then receives the opposite of that change, whatever the contacts' forces.
inline bool reacts_by_momentum(const ContactStep& step, std::size_t body) {
  return step.scene.operators.size() == 1 && step.scene.joints.empty() && step.body_contacts.empty() &&
         step.changes.mean_impact_time(body) == 0.0;
}

}  // namespace mrhi
