#pragma once

#include "mr_hand_interaction/response/contact_model.h"

namespace mrhi {

/// Penetration forces only, after the paper's reference [10] (Hoell et al. 2018).
class PenetrationModel : public ContactModel {
 public:
  void respond(ContactStep& step) override;
};

}  // namespace mrhi
