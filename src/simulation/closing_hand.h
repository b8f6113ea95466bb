#pragma once

#include <optional>
#include <vector>

#include "../collision/contact_finder.h"
#include "grasp_objects.h"
#include "mr_hand_interaction/response/grip.h"
#include "mr_hand_interaction/tracking/hand_track.h"

namespace mrhi {

bool has_tip(const Hand& hand, int finger);
/// True for the capsules that fingers close against: the palm with its metacarpals, or the thumb.
inline bool is_base(bool by_palm, int capsule) {
  if (by_palm) return capsule == kPalm || bone_of(capsule) == 0;
  return finger_of(capsule) == 0;
}

/// Motion of the fingers about an object within a frame. Bodies are where the frame begins, the hand where it
/// ends.
class ClosingHand {
 public:
  using Object = GraspObjects::Object;
  using Poses = std::vector<Pose>;

  /// Keeps references.
  ClosingHand(const Scene& scene, const ContactFinder& finder) : scene_(scene), finder_(finder) {}

  /// True if a finger closes on the object, which lies between it and the thumb.
  bool closes_on(const HandTrack& track, const Object& object, const Poses& poses) const;
  /// Distance from the object to one side of a grip, its base or its fingers: negative inside, limited [m].
  double gap(const Hand& hand, bool by_palm, bool of_base, const Object& object, const Poses& poses) const;
  /// True if the aperture between the finger's tip and its base is shrinking, as opposed to changing because
  /// the hand moves.
  static bool closes(const HandTrack& track, bool by_palm, int finger);

 private:
  /// The closest point of an object, and its body.
  struct Nearest {
    ClosestFeatures features;
    int body;
  };
  bool closes_on(const HandTrack& track, int finger, const Object& object, const Poses& poses) const;
  std::optional<Nearest> nearest(const Capsule& capsule, const Object& object, const Poses& poses,
                                 double margin) const;
  bool on_opposite_faces(const Hand& hand, int finger, const Object& object, const Poses& poses) const;

  const Scene& scene_;
  const ContactFinder& finder_;
};

}  // namespace mrhi
