#pragma once

#include <optional>
#include <vector>

#include "closest_features.h"
#include "mr_hand_interaction/collision/contact.h"
#include "mr_hand_interaction/configuration.h"
#include "mr_hand_interaction/integration/body_state.h"
#include "mr_hand_interaction/scene/scene.h"
#include "neighbours.h"
#include "scene_geometry.h"
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

/// God objects of a pair (Zilles & Salisbury 1995): turns the present closest features (body frame) into one
/// contact, or two where the capsule lies along a face, which continue the `count` contacts `before` of the
/// last step. A god object stays on the face of entry, however deep the phalanx goes, and moves along it only
/// by slip (response) or rolling. Writes the contacts to `now`, which holds two, and returns their number.
int update_god_objects(const TouchingPair& pair, const ClosestFeatures& features, const AxisSpan& span,
                       const Contact* before, int count, Contact* now);

/// Finds what each hand touches, or is about to touch in the step.
class ContactFinder {
 public:
  /// Keeps references.
  ContactFinder(const Scene& scene, const SceneGeometry& geometry, const Vector3& gravity,
                const ContactConfiguration& refinements = {});

  /// Every step: replaces `contacts` (sorted by key) by the present ones. Lasting contacts keep their memory.
  void find(const std::vector<HandMotion>& hands, const Neighbours& neighbours,
            const std::vector<BodyState>& bodies, double step, std::vector<Contact>& contacts);

  /// Closest features in world between a capsule and one shape of a body, if nearer than `margin` [m].
  std::optional<ClosestFeatures> closest(const Capsule& capsule, int body, int shape, const Pose& body_pose,
                                         double margin) const;

  /// A body's frame in world.
  struct PlacedFrame {
    Matrix3 rotation;
    Vector3 position;
  };
  /// The same for a placed body; sets `span`, if given, to the part that lies flat.
  std::optional<ClosestFeatures> closest(const Capsule& capsule, int body, int shape,
                                         const PlacedFrame& frame, double margin,
                                         AxisSpan* span = nullptr) const;

 private:
  void find_pair(const MovingHand& hand, const NearBody& near, const BodyState& state, double step,
                 const std::vector<Contact>& before);
  void share_between_shapes(std::size_t first);
  void find_touch(const TouchingPair& pair, double step, double margin, const std::vector<Contact>& before);
  /// Closest features, in the shape's frame, at the pair's first touch within the step, if any.
  std::optional<ClosestFeatures> swept(const TouchingPair& pair, const PlacedCollider& collider, double step,
                                       double margin) const;
  void touch(const TouchingPair& pair, const ClosestFeatures& features, const AxisSpan& span,
             const std::vector<Contact>& before);

  const Scene& scene_;
  const SceneGeometry& geometry_;
  const Vector3 gravity_;
  const ContactConfiguration refinements_;
  std::vector<Contact> found_;
  std::vector<double> factors_;  // of shares
  std::size_t found_count_ = 0;
  const Contact* memory_ = nullptr;  // in the last step, from those of the pair at hand on
};

}  // namespace mrhi
