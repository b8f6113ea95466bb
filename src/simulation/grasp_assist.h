#pragma once

#include <vector>

#include "closing_hand.h"
#include "mr_hand_interaction/simulation_state.h"
#include "operators.h"

namespace mrhi {

/// Grasp assist, for hands that feel nothing and close through things. Two parts:
///
/// Compliance: a finger that closes on a body touches it without force until another part of the hand touches
/// an opposite face. The first finger then does not knock the body away.
///
/// Support: a hand that has a body between two opposed sides, deeper than a fingertip pad, takes it (Grip).
/// Contacts act as ever. Only if the body slips, or its contacts no longer oppose each other, and it is off
/// its place in the hand, the grip becomes active: springs of bounded force add what the contacts lack, until
/// the hand opens.
///
/// All bodies of a floating linkage are one object: a thumb on its base and a finger on its lid are two
/// sides. An object may be without assist, or not to be grasped at all (GraspMode).
class GraspAssist {
 public:
  /// Keeps references.
  GraspAssist(const Scene& scene, const ContactFinder& finder, const Operators& operators,
              const Configuration& configuration);

  /// Call once a frame of `seconds`, when the hands' next poses are known: begins and ends grips.
  void begin_frame(const Neighbours& neighbours, double seconds, SimulationState& state);
  /// Call at `now` when hands may have been lost: their grips wait for kMaxLoss, and then end.
  void lose_hands(Nanoseconds now, SimulationState& state);
  /// Call every step of `step` seconds, `fraction` of the way into the frame: sets compliance depths and the
  /// grips' springs.
  void begin_step(double fraction, double step, SimulationState& state) const;

 private:
  /// A hand that closes on a body.
  struct ClosingPair {
    std::size_t hand, body;
  };
  using Object = ClosingHand::Object;
  const Object& object_of(std::size_t body) const { return objects_[object_index_[body]]; }
  GraspMode mode_of(std::size_t body) const { return modes_[object_index_[body]]; }
  /// True if the hand has the body in this grip, or another part of the same object.
  bool is_in(const Grip& grip, std::size_t hand, std::size_t body) const {
    return grip.hand == hand && object_index_[grip.body] == object_index_[body];
  }
  const std::vector<Pose>& poses_of(std::size_t slot, std::size_t body, const SimulationState& state) const;
  bool is_opposed(const Contact& contact, const std::vector<Contact>& contacts) const;
  bool slips(const std::vector<Contact>& contacts, const Grip& grip) const;
  bool is_shown_in(std::size_t slot, std::size_t body, const SimulationState& state) const;
  bool is_buried(std::size_t slot, const SimulationState& state) const;
  /// Opposing contacts of a hand that could hold an object between them. World.
  struct Opposed {
    double depth = 0.0;     ///< of the deeper contact [m]
    double squeeze = 0.0;   ///< of both contacts together [m]
    Vector3 base, fingers;  ///< where they touch
    bool by_palm = false;
    std::size_t body = 0;          ///< that the base touches
    std::uint8_t taking_part = 0;  ///< fingers, a bit each
  };
  template <typename See>
  void each_opposed(std::size_t slot, std::size_t body, bool by_palm, const std::vector<Contact>& contacts,
                    const See& see) const;
  bool is_opposed(std::size_t slot, std::size_t body, bool by_palm,
                  const std::vector<Contact>& contacts) const;
  /// Whether all fingers that touch the object take part in the grip.
  bool only_fingers_of(const Grip& grip, const std::vector<Contact>& contacts) const;
  std::optional<Opposed> opposed(std::size_t slot, std::size_t body, bool by_palm,
                                 const std::vector<Contact>& contacts) const;
  /// Whether the base, and the fingers, of a grip touch the object.
  struct TouchingSides {
    bool base = false, fingers = false;

    bool both() const { return base && fingers; }
    bool none() const { return !base && !fingers; }
  };
  TouchingSides touching_sides(const Grip& grip, const std::vector<Contact>& contacts) const;
  bool ends(const SimulationState& state, Grip& grip) const;
  bool holds_again(const SimulationState& state, Grip& grip) const;
  bool opens(const SimulationState& state, const TouchingSides& touching, Grip& grip) const;
  void follow(SimulationState& state, Grip& grip);
  void take_what_is_held(double fraction, SimulationState& state) const;
  void take(std::size_t slot, const Opposed& opposed, double fraction, SimulationState& state) const;
  void place(double fraction, double until, const HandTrack& track, Grip& grip) const;
  void leave_joints_free(double step, SimulationState& state, Grip& grip) const;
  double offset(const SimulationState& state, const Grip& grip) const;
  void set_compliance(const SimulationState& state, double step, Contact& contact) const;

  const Scene& scene_;
  const Operators& operators_;
  ClosingHand closing_hand_;
  const ContactConfiguration configuration_;
  std::vector<Object> objects_;
  std::vector<std::size_t> object_index_;  // by body, in objects_
  std::vector<double> friction_angle_;     // by body [rad]
  std::vector<GraspMode> modes_;           // of objects: free, assist or never
  bool acts_ = false;                      // there is an object that is not free
  mutable std::vector<Pose> poses_;        // of poses_of()
  double seconds_ = 0.0;                   // of the frame
  std::vector<ClosingPair> closing_;       // in this frame
};

}  // namespace mrhi
