#include "mr_hand_interaction/response/contact_model.h"

#include "../text/registry.h"
#include "contact_model_list.h"
#include "contact_step.h"
#include "implicit_model.h"
#include "joint_response.h"

namespace mrhi {

#define MRHI_DECLARE(name) extern const ContactModelEntry name;
#define MRHI_ADDRESS(name) &(name),
MRHI_ENTRIES(MRHI_DECLARE)

namespace {

/// A model of what hands do to objects, with `implicit` for what objects do to each other.
/// In this order, as far as a step goes: hands change momenta, and objects meet each other with what that
/// has made of them. A hand does not feel in the same step what lies behind the object that it pushes.
class WithObjects : public ContactModel {
 public:
  WithObjects(std::unique_ptr<ContactModel> hands, const Configuration& configuration)
      : hands_(std::move(hands)), objects_(configuration.contact) {}

  void respond(ContactStep& step) override {
    ContactStep of_hands{step.scene, step.gravity, step.step,    step.contacts,
                         nothing_,   step.bodies,  step.changes, no_grips_};
    hands_->respond(of_hands);
    if (step.body_contacts.empty()) return;
    ContactStep of_bodies{step.scene,         step.gravity, step.step,    no_hand_,
                          step.body_contacts, step.bodies,  step.changes, no_grips_};
    objects_.respond(of_bodies);
  }

 private:
  std::unique_ptr<ContactModel> hands_;
  ImplicitModel objects_;
  std::vector<Contact> no_hand_;
  std::vector<BodyContact> nothing_;
  std::vector<Grip> no_grips_;
};

/// A model of what hands do to objects, with joints after it, and `implicit` for what objects do to each
/// other if the model does not say.
class WithJoints : public ContactModel {
 public:
  WithJoints(std::unique_ptr<ContactModel> hands, bool of_objects, std::unique_ptr<ContactModel> joints)
      : hands_(std::move(hands)), of_objects_(of_objects), joints_(std::move(joints)) {}

  void respond(ContactStep& step) override {
    ContactStep of_hands{
        step.scene,  step.gravity, step.step, step.contacts, of_objects_ ? step.body_contacts : nothing_,
        step.bodies, step.changes, no_grips_};
    hands_->respond(of_hands);
    ContactStep of_joints{
        step.scene,  step.gravity, step.step, no_hand_, of_objects_ ? nothing_ : step.body_contacts,
        step.bodies, step.changes, no_grips_};
    joints_->respond(of_joints);
  }

 private:
  std::unique_ptr<ContactModel> hands_;
  bool of_objects_;
  std::unique_ptr<ContactModel> joints_;
  std::vector<Contact> no_hand_;
  std::vector<BodyContact> nothing_;
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

std::unique_ptr<ContactModel> make_jointed_model(const Configuration& configuration, const Scene& scene,
                                                 SimulationState& state, std::vector<Event>& events) {
  auto joints = std::make_unique<JointedModel>(configuration, scene, state, events);
  if (configuration.contact_model == ContactModelKind::implicit) return joints;
  const ContactModelEntry& model = entry_of(configuration.contact_model);
  return std::make_unique<WithJoints>(model.make(configuration.contact), model.of_objects, std::move(joints));
}

std::unique_ptr<ContactModel> make_contact_model(const Configuration& configuration) {
  const ContactModelEntry& model = entry_of(configuration.contact_model);
  std::unique_ptr<ContactModel> made = model.make(configuration.contact);
  if (model.of_objects) return made;
  return std::make_unique<WithObjects>(std::move(made), configuration);
}

Material default_material(const Configuration& configuration) {
  Material material = configuration.material;
  material.stiffness = configuration.stiffness.value_or(entry_of(configuration.contact_model).stiffness);
  return material;
}

}  // namespace mrhi
