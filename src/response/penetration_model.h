#pragma once

#include "mr_hand_interaction/response/contact_model.h"
#include "penetration_force.h"

namespace mrhi {

/// Penetration forces only, after the paper's reference [10] (Hoell et al. 2018).
class PenetrationModel : public ContactModel {
 public:
  explicit PenetrationModel(const PenetrationLaw& law) : law_(law) {}
  void respond(ContactStep& step) override;

 private:
  const PenetrationLaw law_;
};

}  // namespace mrhi
