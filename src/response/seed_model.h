#pragma once

#include "impact_solver.h"
#include "mr_hand_interaction/response/contact_model.h"
#include "penetration_force.h"

namespace mrhi {

/// The paper's two phases, equation by equation: an impulse when a phalanx strikes (3.4.1), then penetration
/// forces with Coulomb friction while it touches (3.4.2). To the letter with contact/damping and
/// contact/release_fade false; docs/equations.md has the differences otherwise.
class SeedModel : public ContactModel {
 public:
  explicit SeedModel(const PenetrationLaw& law) : law_(law) {}
  void respond(ContactStep& step) override;

 private:
  const PenetrationLaw law_;
  Islands islands_;
  ImpactSolver impacts_;
};

}  // namespace mrhi
