#include "contact_phase.h"

#include <algorithm>

namespace mrhi {

ContactPhase phase(const Contact& contact) {
  if (!contact.impulse.isZero(0.0)) return ContactPhase::impulse;
  return contact.friction == Friction::sticking ? ContactPhase::sticking : ContactPhase::slipping;
}

const char* phase_name(ContactPhase phase) {
  constexpr const char* kNames[] = {"impulse", "sticking", "slipping"};
  return kNames[static_cast<std::size_t>(phase)];
}

FrictionUse friction_use(const Contact& contact, const Material& material) {
  const double normal = -contact.force.dot(contact.normal);
  const bool slides = contact.friction == Friction::slipping;
  const double friction = slides ? material.dynamic_friction : material.static_friction;
  return {normal, (contact.force + normal * contact.normal).norm(), friction * std::max(normal, 0.0)};
}

std::optional<GraspSupport> assist_on(std::size_t body, const FrameResult& result) {
  std::optional<GraspSupport> sum;
  for (const GraspSupport& assist : result.assists) {
    if (assist.body != body) continue;
    if (!sum) sum = GraspSupport{};
    sum->force += assist.force, sum->torque += assist.torque;
  }
  return sum;
}

const char* finger_name(int capsule) {
  constexpr const char* kNames[] = {"thumb", "index", "middle", "ring", "little", "palm"};
  return kNames[finger_of(capsule)];
}

const char* bone_name(int capsule) {
  constexpr const char* kNames[] = {"metacarpal", "proximal", "intermediate", "distal"};
  return capsule == kPalm ? "palm" : kNames[bone_of(capsule)];
}

std::uint32_t hand_id(const Contact& contact, const SimulationState& state) {
  return state.hands[contact.key.hand].current.id;
}

}  // namespace mrhi
