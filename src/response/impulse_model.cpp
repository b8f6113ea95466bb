#include "contact_step.h"
#include "impact_solver.h"

namespace mrhi {
namespace {

/// Impulses only: every step in which a touching phalanx approaches the object is an impact. Nothing holds an
/// object.
class ImpulseModel : public ContactModel {
 public:
  // Eqs. 9 to 15 alone. `struck` is reset, so each step is a new approach. Without an approach no force acts,
  // so a body slides out of any grip (docs/speed_accuracy.md#where-each-contact-model-is-stable).
  void respond(ContactStep& step) override {
    for (Contact& contact : step.contacts) {
      contact.force.setZero();
      contact.struck = false;
    }
    islands_.build(step);
    impacts_.resolve(step, islands_, ImpactFriction::none);
  }

 private:
  Islands islands_;
  ImpactSolver impacts_;
};

}  // namespace

/// The default stiffness is the paper's.
extern const ContactModelEntry impulse_model{"impulse", 3, 100.0, make_model<ImpulseModel>};

}  // namespace mrhi
