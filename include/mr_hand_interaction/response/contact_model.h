#pragma once

#include <memory>
#include <vector>

#include "mr_hand_interaction/collision/body_contact.h"
#include "mr_hand_interaction/collision/contact.h"
#include "mr_hand_interaction/configuration.h"
#include "mr_hand_interaction/integration/body_state.h"
#include "mr_hand_interaction/response/grip.h"
#include "mr_hand_interaction/response/step_changes.h"
#include "mr_hand_interaction/scene/scene.h"

namespace mrhi {

/// What a contact model works on in one step.
struct ContactStep {
  const Scene& scene;
  const Vector3& gravity;                   ///< [m/s^2]
  double step;                              ///< [s]
  std::vector<Contact>& contacts;           ///< with hands, sorted by key; the model fills what acts
  std::vector<BodyContact>& body_contacts;  ///< of bodies with each other, sorted by key; likewise
  std::vector<BodyState>& bodies;  ///< the model changes momenta; free flight then advances the poses
  StepChanges& changes;
  std::vector<Grip>& grips;  ///< what hands hold, by hand and body; `implicit` alone knows them
};

/// How an object answers a touch. All memory is in the contacts: a model keeps nothing but scratch space.
class ContactModel {
 public:
  virtual ~ContactModel() = default;
  virtual void respond(ContactStep& step) = 0;
};

/// Objects touch each other by the law of `implicit` under every model.
std::unique_ptr<ContactModel> make_contact_model(const Configuration& configuration);

}  // namespace mrhi
