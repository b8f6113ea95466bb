#pragma once

#include <memory>
#include <vector>

#include "mr_hand_interaction/collision/contact.h"
#include "mr_hand_interaction/configuration.h"
#include "mr_hand_interaction/integration/body_state.h"
#include "mr_hand_interaction/scene/scene.h"

namespace mrhi {

/// What a contact model works on in one step.
struct ContactStep {
  const Scene& scene;
  const Vector3& gravity;          ///< [m/s^2]
  double step;                     ///< [s]
  std::vector<Contact>& contacts;  ///< sorted by key; the model fills force, impulse and friction
  std::vector<BodyState>& bodies;  ///< the model changes momenta; free flight then advances the poses
  std::vector<char>& solved;  ///< set for a body whose momenta are those of the step's end, gravity included
};

/// How an object answers a touch. Stateless: all memory is in the contacts.
class ContactModel {
 public:
  virtual ~ContactModel() = default;
  virtual void respond(ContactStep& step) const = 0;
};

std::unique_ptr<const ContactModel> make_contact_model(const Configuration& configuration);

}  // namespace mrhi
