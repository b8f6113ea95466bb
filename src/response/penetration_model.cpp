#include "penetration_model.h"

namespace mrhi {

void PenetrationModel::respond(ContactStep& step) {
  penetration_phase(law_, step);
}

/// The paper's stiffness.
extern const ContactModelEntry penetration_model{
    "penetration", 2, 100.0, [](const ContactConfiguration& configuration) -> std::unique_ptr<ContactModel> {
      return std::make_unique<PenetrationModel>(penetration_law(configuration));
    }};

}  // namespace mrhi
