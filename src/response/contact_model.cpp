#include "mr_hand_interaction/response/contact_model.h"

#include "implicit_model.h"
#include "impulse_model.h"
#include "penetration_model.h"
#include "seed_model.h"
#include "soft_pad_model.h"
#include "virtual_spring_model.h"

namespace mrhi {
namespace {

/// A model of what hands do to objects, with `implicit` for what objects do to each other.
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

}  // namespace

std::unique_ptr<ContactModel> make_contact_model(const Configuration& configuration) {
  const auto with_objects = [&](std::unique_ptr<ContactModel> hands) {
    return std::make_unique<WithObjects>(std::move(hands), configuration);
  };
  switch (configuration.contact_model) {
    case ContactModelKind::seed:
      return with_objects(std::make_unique<SeedModel>());
    case ContactModelKind::penetration:
      return with_objects(std::make_unique<PenetrationModel>());
    case ContactModelKind::impulse:
      return with_objects(std::make_unique<ImpulseModel>());
    case ContactModelKind::virtual_spring:
      return with_objects(std::make_unique<VirtualSpringModel>());
    case ContactModelKind::soft_pad:
      return with_objects(std::make_unique<SoftPadModel>());
    case ContactModelKind::implicit:
      break;
  }
  return std::make_unique<ImplicitModel>(configuration.contact);
}

}  // namespace mrhi
