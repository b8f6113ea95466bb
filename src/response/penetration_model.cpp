#include "contact_step.h"
#include "penetration_force.h"

namespace mrhi {
namespace {

/// Penetration forces only, after the paper's reference [10] (Hoell et al. 2018).
class PenetrationModel : public ContactModel {
 public:
  explicit PenetrationModel(const ContactConfiguration& configuration) : configuration_(configuration) {}
  void respond(ContactStep& step) override;

 private:
  const ContactConfiguration configuration_;
};

}  // namespace

void PenetrationModel::respond(ContactStep& step) {
  penetration_phase(configuration_, step);
}

/// The default stiffness is the paper's.
extern const ContactModelEntry penetration_model{
    "penetration", 2, 100.0, [](const ContactConfiguration& configuration) -> std::unique_ptr<ContactModel> {
      return std::make_unique<PenetrationModel>(configuration);
    }};

}  // namespace mrhi
