#include "virtual_spring_model.h"

#include <algorithm>
#include <cmath>

#include "impact.h"
#include "penetration_force.h"

namespace mrhi {
namespace {

/// Force of the coupling on the object [N]; drags the virtual phalanx where it slips.
Vector3 coupling_force(const Body& body, const BodyState& state, Contact& contact) {
  const double stiffness = body.material.stiffness * contact.share;
  if (!contact.touching() || stiffness <= 0.0) return Vector3::Zero();
  const double damping =
      2.0 * std::sqrt(body.material.stiffness * VirtualSpringModel::kPhalanxMass) * contact.share;
  const Vector3& n = contact.normal;
  const Vector3 velocity = relative_velocity(contact, body, state);
  const double normal_velocity = n.dot(velocity);
  // The virtual phalanx rests on the surface: the coupling presses it on, but the surface cannot hold it
  // back.
  const double push = std::max(0.0, stiffness * contact.depth - damping * normal_velocity);

  const Vector3 reach = contact.hand_point - contact.point;
  const Vector3 stretch = reach - n.dot(reach) * n;
  const Vector3 along = velocity - normal_velocity * n;
  const Tangential tangential =
      coulomb(stiffness * stretch + damping * along, push, body.material, contact.friction);
  contact.friction = tangential.friction;
  if (tangential.friction == Friction::slipping) {
    contact.point += stretch - tangential.force / stiffness;
    contact.god_object = state.pose.to_local(contact.point);
  }
  return tangential.force - push * n;
}

}  // namespace

void VirtualSpringModel::respond(ContactStep& step) {
  for (Contact& contact : step.contacts) {
    const std::size_t body = contact.key.body;
    contact.force = coupling_force(step.scene.bodies[body], step.bodies[body], contact);
  }
  for (const Contact& contact : step.contacts) {
    const std::size_t body = contact.key.body;
    if (!step.scene.bodies[body].fixed)
      apply_impulse(step.step * contact.force, contact.point, step.bodies[body]);
  }
}

extern const ContactModelEntry virtual_spring_model{
    "virtual_spring", 4, VirtualSpringModel::kStiffness,
    [](const ContactConfiguration&) -> std::unique_ptr<ContactModel> {
      return std::make_unique<VirtualSpringModel>();
    }};

}  // namespace mrhi
