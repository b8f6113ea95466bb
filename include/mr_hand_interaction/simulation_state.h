#pragma once

#include <cstdint>
#include <vector>

#include "mr_hand_interaction/collision/body_contact.h"
#include "mr_hand_interaction/collision/contact.h"
#include "mr_hand_interaction/integration/body_state.h"
#include "mr_hand_interaction/interaction.h"
#include "mr_hand_interaction/rendering/rendered_hand.h"
#include "mr_hand_interaction/response/grip.h"
#include "mr_hand_interaction/scene/scene.h"
#include "mr_hand_interaction/stamp_check.h"
#include "mr_hand_interaction/tracking/hand_track.h"

namespace mrhi {

/// Everything that changes. A copy is a checkpoint: continuing from it gives the same bits.
struct SimulationState {
  bool started = false;            ///< a frame has been taken
  Nanoseconds time = 0;            ///< stamp up to which bodies have been advanced
  Nanoseconds last_frame = 0;      ///< stamp of the last frame taken
  StampCheck stamps;               ///< of the frames taken, and of those that were refused
  std::vector<BodyState> bodies;   ///< one per Scene::bodies, fixtures too
  std::vector<JointState> joints;  ///< one per Scene::joints
  std::vector<char> asleep;        ///< one per Scene::bodies: at rest, and not simulated until disturbed
  std::vector<char> restrained;    ///< one per Scene::operators: a restraint holds the operator
  std::vector<HandTrack> hands;    ///< slots; see HandTrack::active
  std::vector<Contact> contacts;   ///< of hands with bodies, sorted by key
  std::vector<BodyContact> body_contacts;      ///< of bodies with each other, sorted by key
  std::vector<BodyContact> sleeping_contacts;  ///< likewise, of bodies that are asleep
  std::vector<HandOffset> offsets;             ///< of the rendered hands, by slot
  std::vector<MassLag> mass_lags;              ///< likewise
  std::vector<Grip> grips;                     ///< of hands and objects, by hand and body
  std::vector<Interaction> interactions;       ///< one per body and hand slot: hand * bodies + body
};

/// Velocity of a joint from the motion of its bodies [rad/s, m/s].
double joint_velocity(const Scene& scene, std::size_t joint, const std::vector<BodyState>& bodies);

/// Wakes all bodies.
void wake_all(SimulationState& state);

/// True if any hand grasps the body.
bool is_held(std::size_t body, const SimulationState& state);
/// Removes all contacts of a body. Wakes all bodies.
void forget_contacts(std::size_t body, SimulationState& state);

/// Marks a body as spawned where it is: a hand that overlaps it neither pushes it nor is rendered outside it
/// until they have separated.
void mark_appeared(std::size_t body, SimulationState& state);
/// Marks all hands as re-acquired, after an operator was placed: they touch nothing until they have been
/// clear of it.
void mark_hands_appeared(SimulationState& state);
/// Places a body: removes its contacts and marks it as spawned there.
void place(std::size_t body, const BodyState& placed, SimulationState& state);

/// FNV-1a over the bits of all members that determine the future. Stamps are relative to `time`: the same
/// motion at another time of day has the same hash.
std::uint64_t hash(const SimulationState& state);

}  // namespace mrhi
