#pragma once

#include <array>
#include <optional>
#include <vector>

#include "mr_hand_interaction/collision/contact_finder.h"
#include "mr_hand_interaction/simulation_state.h"

namespace mrhi {

/// Help for hands that feel nothing and close through things. Fingers that close round a body give way to it,
/// as those of a person do who feels it, so that the first of them does not bat it away. When both sides have
/// reached it where friction could hold it, and are in it deeper than a pulp gives, a Grip holds it, until
/// the hand has opened again. All other touches are as ever.
class GraspAssist {
 public:
  /// Keeps references.
  GraspAssist(const Scene& scene, const ContactFinder& finder, const Vector3& gravity,
              const ContactConfiguration& configuration);

  /// Once a frame of `seconds`, when the hands' next poses are known: what is taken, and what is let go.
  void begin_frame(const Neighbours& neighbours, double seconds, SimulationState& state);
  /// Ends the grips of hands that have opened, jumped or are lost.
  void let_go(SimulationState& state);
  /// Every step, `fraction` of the way into the frame: which contacts give way, and where grips are.
  void begin_step(double fraction, SimulationState& state) const;
  /// After the response: what each contact of a grip has of its force.
  void share_force(SimulationState& state) const;

 private:
  /// How a hand closes on a body.
  enum class Closing : std::uint8_t {
    none,
    pinch,  ///< one finger, or what lies between finger and thumb or palm
    grab    ///< several fingers
  };
  struct ClosingOn {
    std::size_t hand, body;
    Closing closing;
  };
  /// A capsule of the hand that is in the body, by the way out that is nearest.
  struct Touch {
    bool touches = false;
    double depth = 0.0;   // [m]
    double radius = 0.0;  // of the capsule [m]
    Vector3 normal, point;
  };
  using Touches = std::array<Touch, kCapsules>;
  /// Two sides of a hand that could hold a body between them.
  struct Opposed {
    double depth;           // of the deeper side [m]
    double width;           // opening at which both just touch [m]
    Vector3 base, fingers;  // where they touch
    bool by_palm;
    std::uint8_t taking_part;
  };

  /// What a hand's fingers do about a body.
  struct Look {
    std::optional<Touches> touches;  // found when first asked for
    std::optional<Opposed> opposed;
    Closing closing = Closing::none;
    int fingers = 0;  // that close towards the palm
  };

  void look_at(std::size_t slot, int body, SimulationState& state);
  void look_along(const HandTrack& track, bool by_palm, int finger, int body, const BodyState& state,
                  Look& look) const;
  bool closes(const HandTrack& track, bool by_palm, int finger) const;
  double way_off(const Hand& hand, bool by_palm, int finger, int body, const Pose& pose) const;
  Touches touches(const Hand& hand, int body, const Pose& pose) const;
  std::optional<Opposed> opposed(const Touches& touches, bool by_palm, int finger, double friction) const;
  void take(std::size_t slot, int body, const Opposed& opposed, SimulationState& state) const;
  void give_way(const SimulationState& state, Contact& contact) const;
  bool gives_way(const Contact& contact, const SimulationState& state) const;

  const Scene& scene_;
  const ContactFinder& finder_;
  const Vector3 gravity_;
  const ContactConfiguration configuration_;
  double seconds_ = 0.0;            // of the frame
  std::vector<ClosingOn> closing_;  // in this frame
};

}  // namespace mrhi
