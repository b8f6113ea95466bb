#include "contact_step.h"
#include "impact_solver.h"

namespace mrhi {
namespace {

/// Impulses only: every step in which a phalanx meets an object and still approaches it is an impact; nothing
/// holds.
class ImpulseModel : public ContactModel {
 public:
  void respond(ContactStep& step) override;

 private:
  Islands islands_;
  ImpactSolver impacts_;
};

}  // namespace

// Eqs. 9 to 15 alone. That `struck` is forgotten in every step makes each step an approach of its own; as
// nothing pushes where nothing approaches, a body slides out of any grip
// (docs/speed_accuracy.md#where-each-contact-model-is-stable).
void ImpulseModel::respond(ContactStep& step) {
  for (Contact& contact : step.contacts) {
    contact.force.setZero();
    contact.struck = false;
  }
  islands_.build(step);
  impacts_.resolve(step, islands_, ImpactFriction::none);
}

/// The paper's stiffness.
extern const ContactModelEntry impulse_model{
    "impulse", 3, 100.0, [](const ContactConfiguration&) -> std::unique_ptr<ContactModel> {
      return std::make_unique<ImpulseModel>();
    }};

}  // namespace mrhi
