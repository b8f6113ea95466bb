#pragma once

#include <array>
#include <optional>

#include "../collision/contact_finder.h"
#include "mr_hand_interaction/response/grip.h"
#include "mr_hand_interaction/tracking/hand_track.h"

namespace mrhi {

bool has_tip(const Hand& hand, int finger);
/// True for what fingers close against: the palm with its metacarpals, or the thumb.
bool is_base(bool by_palm, int capsule);

/// What a hand does about a body, from a frame to the next: which fingers close on it, and whether two sides
/// of the hand have it between them. Bodies as they are when the frame begins, the hand as when it ends.
class ClosingHand {
 public:
  /// Two sides of a hand that could hold a body between them. World.
  struct Opposed {
    double depth;           ///< of the deeper side [m]
    double squeeze;         ///< of both sides together [m]
    Vector3 base, fingers;  ///< where they touch
    bool by_palm;
    std::uint8_t taking_part;  ///< fingers, a bit each
  };
  /// A capsule of the hand that is in the body, by the way out that is nearest.
  struct Touch {
    bool touches = false;
    double depth = 0.0;  ///< [m]
    Vector3 normal, point;
  };
  using Touches = std::array<Touch, kCapsules>;
  struct Look {
    std::optional<Touches> touches;  ///< found when first asked for
    std::optional<Opposed> opposed;
    std::uint8_t closing = 0;  ///< fingers that close on it, a bit each
  };

  /// Keeps references.
  ClosingHand(const Scene& scene, const ContactFinder& finder) : scene_(scene), finder_(finder) {}

  Look look_at(const HandTrack& track, int body, const Pose& pose) const;
  /// Distance of a side of a grip, its base or its fingers, from the body; negative inside; at most `limit`
  /// [m].
  double gap(const Hand& hand, bool by_palm, bool of_base, int body, const Pose& pose, double limit) const;
  /// True if the aperture between the finger's tip and its base is shrinking, as opposed to changing because
  /// the hand moves.
  static bool closes(const HandTrack& track, bool by_palm, int finger);
  /// Mean speed at which the aperture between the finger's tip and its base shrinks [m/s].
  static double closing_speed(const HandTrack& track, bool by_palm, int finger);

 private:
  void look_along(const HandTrack& track, bool by_palm, int finger, int body, const Pose& pose,
                  Look& look) const;
  std::optional<ClosestFeatures> nearest(const Capsule& capsule, int body, const Pose& pose,
                                         double margin) const;
  bool on_opposite_faces(const Hand& hand, bool by_palm, int finger, int body, const Pose& pose) const;
  Touches touches(const Hand& hand, int body, const Pose& pose) const;
  std::optional<Opposed> opposed(const Touches& touches, bool by_palm, int finger, double friction) const;

  const Scene& scene_;
  const ContactFinder& finder_;
};

}  // namespace mrhi
