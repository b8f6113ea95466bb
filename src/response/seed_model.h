#pragma once

#include "impact_solver.h"
#include "mr_hand_interaction/response/contact_model.h"

namespace mrhi {

/// The paper's two phases, equation by equation: an impulse when a phalanx strikes (3.4.1), then penetration
/// forces with Coulomb friction while it touches (3.4.2). See docs/equations.md for each difference.
class SeedModel : public ContactModel {
 public:
  void respond(ContactStep& step) override;

 private:
  Islands islands_;
  ImpactSolver impacts_;
};

}  // namespace mrhi
