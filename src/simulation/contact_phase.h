#pragma once

#include <optional>

#include "mr_hand_interaction/simulation.h"

namespace mrhi {

/// State of a contact, as numbered in recordings and messages.
enum class ContactPhase : std::uint8_t { impulse = 0, sticking = 1, slipping = 2 };
ContactPhase phase(const Contact& contact);
const char* phase_name(ContactPhase phase);

/// Friction force of a contact and its limit [N].
struct FrictionUse {
  double normal;      ///< normal force
  double tangential;  ///< norm of the tangential force
  double limit;       ///< largest tangential force: Coulomb's coefficient times the normal force
};
FrictionUse friction_use(const Contact& contact, const Material& material);

/// Wrench of grasp assist on a body, of all hands; nullopt if none supports it.
std::optional<GraspSupport> assist_on(std::size_t body, const FrameResult& result);

/// thumb, index, middle, ring, little; palm.
const char* finger_name(int capsule);
/// metacarpal, proximal, intermediate, distal; palm.
const char* bone_name(int capsule);

/// The tracker's id of the contact's hand.
std::uint32_t hand_id(const Contact& contact, const SimulationState& state);

}  // namespace mrhi
