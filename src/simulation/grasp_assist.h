#pragma once

#include <vector>

#include "grasp_objects.h"
#include "mr_hand_interaction/simulation_state.h"
#include "operators.h"

namespace mrhi {

/// Grasp assist for hands without force feedback, which close through objects. It has two parts:
///
/// Compliance: a finger that closes on a body adds no force by its own motion until another part of the hand
/// touches an opposite face. The first finger then does not knock the body away.
///
/// Support: a hand acquires a body between opposing contact groups, deeper than a fingertip pad (Grip).
/// Contacts act as usual. The grip becomes active only if the body slips, or its contacts no longer oppose
/// each other, and it has left its place in the hand: springs of bounded force then add what the contacts
/// lack, until the hand opens.
///
/// GraspObjects has the objects. An object may be without assist, or not to be grasped at all (GraspMode).
class GraspAssist {
 public:
  /// Keeps references.
  GraspAssist(const Scene& scene, const ContactFinder& finder, const Operators& operators,
              const Configuration& configuration);

  /// Call once a frame of `seconds`, when the hands' next poses are known: begins and ends grips.
  void begin_frame(const Neighbours& neighbours, double seconds, SimulationState& state);
  /// Call at `now` when hands may have been lost: they take what they hold, and their grips wait for
  /// kMaxLoss.
  void lose_hands(Nanoseconds now, SimulationState& state);
  /// Call every step of `step` seconds, `fraction` of the way into the frame: sets compliance depths and the
  /// grips' springs.
  void begin_step(double fraction, double step, SimulationState& state) const;

 private:
  /// A hand that closes on a body.
  struct ClosingPair {
    std::size_t hand, body;
  };
  using Object = GraspObjects::Object;
  const std::vector<Pose>& poses_of(std::size_t slot, std::size_t body, const SimulationState& state) const;
  bool is_shown_in(std::size_t slot, std::size_t body, const SimulationState& state) const;
  bool is_buried(std::size_t slot, const SimulationState& state) const;
  bool has_ended(const SimulationState& state, Grip& grip) const;
  bool resumes(const SimulationState& state, Grip& grip) const;
  bool has_opened(const SimulationState& state, const TouchingGroups& touching, Grip& grip) const;
  bool has_left(const SimulationState& state, const Grip& grip) const;
  bool is_held_elsewhere(const SimulationState& state, const Grip& grip) const;
  void follow(SimulationState& state, Grip& grip);
  std::vector<Grip>::iterator find_grip(std::size_t slot, std::size_t body, SimulationState& state) const;
  void take_held_objects(bool seen, double fraction, SimulationState& state) const;
  void take(std::size_t slot, const OpposingContacts& opposing, double fraction,
            SimulationState& state) const;
  void place_springs(double fraction, double until, const HandTrack& track, Grip& grip) const;
  void comply_with_contacts(double step, const SimulationState& state, Grip& grip) const;
  void leave_joints_free(double step, SimulationState& state, Grip& grip) const;
  double offset(const SimulationState& state, const Grip& grip) const;
  void set_compliance(const SimulationState& state, double step, Contact& contact) const;

  const Scene& scene_;
  const Operators& operators_;
  ClosingHand closing_hand_;
  const ContactConfiguration configuration_;
  const GraspObjects objects_;
  mutable std::vector<Pose> poses_;   // of poses_of()
  double seconds_ = 0.0;              // of the frame
  std::vector<ClosingPair> closing_;  // in this frame
};

}  // namespace mrhi
