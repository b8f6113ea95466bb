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

/// What there is of a contact model before it is made. The file src/response/NAME_model.cpp defines
/// NAME_model; the build finds it, and all else asks contact_models().
struct ContactModelEntry {
  const char* name;
  int place;         ///< in lists
  double stiffness;  ///< its own: of bodies that the scene says nothing about [N/m]
  std::unique_ptr<ContactModel> (*make)(const ContactConfiguration&);
  bool of_objects = false;  ///< it answers touches between objects too
};

/// In the order of their places.
const std::vector<const ContactModelEntry*>& contact_models();

/// Objects touch each other by the law of `implicit` under every model. Throws std::invalid_argument for a
/// name that is not known.
std::unique_ptr<ContactModel> make_contact_model(const Configuration& configuration);

/// Material of bodies that the scene says nothing about. Its stiffness, if not set, is the contact model's
/// own.
Material default_material(const Configuration& configuration);

}  // namespace mrhi
