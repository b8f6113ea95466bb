#include "contact_step.h"
#include "impact_solver.h"
#include "penetration_force.h"

namespace mrhi {
namespace {

/// The paper's two phases, equation by equation: an impulse when a phalanx strikes (3.4.1), then penetration
/// forces with Coulomb friction while it touches (3.4.2). To the letter with contact/damping and
/// contact/release_fade false; docs/contact.md has the differences otherwise.
class SeedModel : public ContactModel {
 public:
  explicit SeedModel(const PenetrationLaw& law) : law_(law) {}
  void respond(ContactStep& step) override;

 private:
  const PenetrationLaw law_;
  Islands islands_;
  ImpactSolver impacts_;
};

}  // namespace

// The order is the paper's, 3.4.1 and then 3.4.2, and it matters: the springs' forces fade by the
// velocities that the blow has left. Without friction in the blow, since J = j n (Eq. 9).
void SeedModel::respond(ContactStep& step) {
  islands_.build(step);
  impacts_.resolve(step, islands_, ImpactFriction::none);
  // A phalanx that is inside has had its approach, impact or not.
  for (Contact& contact : step.contacts) contact.struck = contact.struck || contact.depth > 0.0;
  penetration_phase(law_, step);
}

/// The paper's stiffness.
extern const ContactModelEntry seed_model{
    "seed", 1, 100.0, [](const ContactConfiguration& configuration) -> std::unique_ptr<ContactModel> {
      return std::make_unique<SeedModel>(penetration_law(configuration));
    }};

}  // namespace mrhi
