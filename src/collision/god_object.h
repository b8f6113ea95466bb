#pragma once

#include <vector>

#include "closest_features.h"
#include "mr_hand_interaction/collision/contact.h"
#include "mr_hand_interaction/configuration.h"
#include "step_motion.h"

namespace mrhi {

/// Gap beyond which a contact loses its memory [m].
constexpr double kSeparation = 0.0005;

/// One capsule of a hand near one shape of a body, and how their contact is modelled.
struct TouchingPair {
  const MovingHand& hand;
  int capsule;
  const Capsule& in_world;  // at the step's start
  const Capsule& in_body;   // the same in the body's frame
  int body;
  int shape;
  const MovingBody& moving;
  const ContactConfiguration& refinements;

  ContactKey key(int point) const {
    return {static_cast<std::uint8_t>(point), static_cast<std::uint8_t>(shape),
            static_cast<std::uint8_t>(capsule), static_cast<std::uint8_t>(hand.slot),
            static_cast<std::uint16_t>(body)};
  }
};

/// God objects of a pair (Zilles & Salisbury 1995, a point per touch): turns the closest features of now
/// (body frame) into one contact, or two where the capsule lies along a face, and carries the memory of the
/// pair's `count` contacts `before`, in the last step, over. A god object stays on the face that the phalanx
/// entered by, however deep the phalanx goes, and moves with it only where friction lets it (response) or
/// where the phalanx rolls. Writes the contacts to `now`, which holds two, and returns how many there are.
int update_god_objects(const TouchingPair& pair, const ClosestFeatures& features, const AxisSpan& span,
                       const Contact* before, int count, Contact* now);

/// Eq. 8 sorted: v = n.(c1' - c2') [m/s], < 0 approaches.
Approach classify(double normal_velocity);

/// Velocity of the object's point c in world (Eq. 7) [m/s].
Vector3 object_velocity(const Twist& twist, const Vector3& centre, const Vector3& point);

}  // namespace mrhi
