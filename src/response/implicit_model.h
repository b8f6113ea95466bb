#pragma once

#include "mr_hand_interaction/response/contact_model.h"

namespace mrhi {

/// The paper's two phases solved at the end of the step: Newton's impact law where a phalanx strikes, and the
/// god-object springs with Coulomb friction and soft-finger torsion as functions of the velocity that
/// results. One convex problem per body, M (v - v*) = h sum J^T f(v), by Newton's method; as the step goes to
/// zero it becomes the seed model. See docs/contact.md.
class ImplicitModel : public ContactModel {
 public:
  explicit ImplicitModel(bool torsion) : torsion_(torsion) {}
  void respond(ContactStep& step) const override;

 private:
  bool torsion_;
};

}  // namespace mrhi
