#pragma once

#include <optional>

#include "mr_hand_interaction/simulation.h"

namespace mrhi {

/// What a contact does, as recordings and messages number it.
enum class ContactPhase : std::uint8_t { impulse = 0, sticking = 1, slipping = 2 };
ContactPhase phase(const Contact& contact);
const char* phase_name(ContactPhase phase);

/// What of friction a contact needs, and what there is [N].
struct FrictionUse {
  double normal;      ///< the push
  double tangential;  ///< of the force along the surface
  double limit;       ///< of that: Coulomb's coefficient times the push
};
FrictionUse friction_use(const Contact& contact, const Material& material);

/// Force of grasp assist on a body, mean over the frame; nullopt if none supports it [N].
std::optional<Vector3> assist_force(std::size_t body, const FrameResult& result);

/// thumb, index, middle, ring, little; palm.
const char* finger_name(int capsule);
/// metacarpal, proximal, intermediate, distal; palm.
const char* bone_name(int capsule);

/// The tracker's id of the contact's hand.
std::uint32_t hand_id(const Contact& contact, const SimulationState& state);

}  // namespace mrhi
