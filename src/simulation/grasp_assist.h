#pragma once

#include <vector>

#include "closing_hand.h"
#include "mr_hand_interaction/simulation_state.h"

namespace mrhi {

/// Help for hands that feel nothing and close through things, in two parts.
///
/// A finger that closes on a body gives way to it, as a person's does who feels it, so that the first finger
/// does not bat the body away. It closes on the body if that lies between it and the thumb, or the palm, on
/// faces that oppose. When it has stopped it comes to press by and by.
///
/// A hand of which two sides have reached a body where friction could hold it, deeper than a pulp gives, has
/// taken it: a Grip. It does nothing as long as contact holds the body. Once the body slips in the hand, the
/// grip bears it, until the hand has opened again. All other touches are as ever.
class GraspAssist {
 public:
  /// Keeps references.
  GraspAssist(const Scene& scene, const ContactFinder& finder, const Vector3& gravity,
              const ContactConfiguration& configuration);

  /// Once a frame of `seconds`, when the hands' next poses are known: what is taken, and what is let go.
  void begin_frame(const Neighbours& neighbours, double seconds, SimulationState& state);
  /// Ends the grips of hands that have opened, jumped or are lost.
  void let_go(SimulationState& state);
  /// Every step of `step` seconds, `fraction` of the way into the frame: which contacts give way, and where
  /// grips are.
  void begin_step(double fraction, double step, SimulationState& state) const;
  /// After the response: what each contact of a grip has of its force.
  void share_force(SimulationState& state) const;

 private:
  /// A body on which a hand closes.
  struct ClosingOn {
    std::size_t hand, body;
    bool grabs;  // with several fingers
  };
  bool buried(std::size_t slot, const SimulationState& state) const;
  void look_at(std::size_t slot, int body, SimulationState& state);
  void take(std::size_t slot, int body, const ClosingHand::Opposed& opposed, SimulationState& state) const;
  bool opens(const SimulationState& state, Grip& grip) const;
  void place(double fraction, double until, const HandTrack& track, Grip& grip) const;
  double off(const SimulationState& state, const Grip& grip) const;
  void give_way(const SimulationState& state, double step, Contact& contact) const;
  bool gives_way(const Contact& contact, const SimulationState& state) const;

  const Scene& scene_;
  ClosingHand closing_hand_;
  const Vector3 gravity_;
  const ContactConfiguration configuration_;
  double seconds_ = 0.0;            // of the frame
  std::vector<ClosingOn> closing_;  // in this frame
};

}  // namespace mrhi
