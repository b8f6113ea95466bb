#include "mr_hand_interaction/response/contact_model.h"

#include "../text/text.h"
#include "contact_model_list.h"
#include "contact_step.h"
#include "implicit_model.h"

namespace mrhi {

#define MRHI_DECLARE(name) extern const ContactModelEntry name;
#define MRHI_ADDRESS(name) &(name),
MRHI_ENTRIES(MRHI_DECLARE)

namespace {

/// A model of contacts with hands, followed by `implicit` for joints and for contacts between objects. The
/// effect of what is behind an object reaches the hand one step later.
class HandsThenRest : public ContactModel {
 public:
  HandsThenRest(std::unique_ptr<ContactModel> hands, std::unique_ptr<ContactModel> rest)
      : hands_(std::move(hands)), rest_(std::move(rest)) {}

  void respond(ContactStep& step) override {
    const auto part = [&](std::vector<Contact>& contacts, std::vector<BodyContact>& body_contacts) {
      return ContactStep{step.scene,    step.gravity, step.step,    step.configuration, contacts,
                         body_contacts, step.bodies,  step.changes, no_grips_};
    };
    ContactStep of_hands = part(step.contacts, no_body_contacts_);
    hands_->respond(of_hands);
    ContactStep of_rest = part(no_contacts_, step.body_contacts);
    rest_->respond(of_rest);
  }

 private:
  std::unique_ptr<ContactModel> hands_;
  std::unique_ptr<ContactModel> rest_;
  std::vector<Contact> no_contacts_;
  std::vector<BodyContact> no_body_contacts_;
  std::vector<Grip> no_grips_;
};

const ContactModelEntry& entry_of(ContactModelKind kind) {
  return entry_named(contact_models(), kind.name, "contact model");
}

}  // namespace

const std::vector<const ContactModelEntry*>& contact_models() {
  static const std::vector<const ContactModelEntry*> models =
      in_their_places<ContactModelEntry>({MRHI_ENTRIES(MRHI_ADDRESS)});
  return models;
}

std::unique_ptr<ContactModel> make_contact_model(const Configuration& configuration, const Scene& scene,
                                                 SimulationState& state, std::vector<Event>& events) {
  const bool jointed = !scene.joints.empty();
  const ContactModelEntry& model = entry_of(configuration.contact_model);
  if (!jointed && model.of_objects) return model.make(configuration.contact);
  std::unique_ptr<ContactModel> rest;
  if (jointed) {
    rest = std::make_unique<JointedModel>(configuration, scene, state, events);
    if (configuration.contact_model == ContactModelKind::implicit) return rest;
  } else {
    rest = std::make_unique<ImplicitModel>();
  }
  return std::make_unique<HandsThenRest>(model.make(configuration.contact), std::move(rest));
}

Material default_material(const Configuration& configuration) {
  Material material = configuration.material;
  material.stiffness = configuration.stiffness.value_or(entry_of(configuration.contact_model).stiffness);
  return material;
}

}  // namespace mrhi
