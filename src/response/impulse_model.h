#pragma once

#include "impact_solver.h"
#include "mr_hand_interaction/response/contact_model.h"

namespace mrhi {

/// Impulses only: every step in which a phalanx meets an object and still approaches it is an impact; nothing
/// holds.
class ImpulseModel : public ContactModel {
 public:
  void respond(ContactStep& step) override;

 private:
  Islands islands_;
  ImpactSolver impacts_;
};

}  // namespace mrhi
