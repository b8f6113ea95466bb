#pragma once

#include <optional>
#include <vector>

#include "closest_features.h"
#include "god_object.h"
#include "mr_hand_interaction/collision/contact.h"
#include "mr_hand_interaction/integration/body_state.h"
#include "mr_hand_interaction/scene/scene.h"
#include "neighbours.h"
#include "scene_geometry.h"
#include "step_motion.h"

namespace mrhi {

/// Finds what each hand touches, or is about to touch in the step.
class ContactFinder {
 public:
  /// Keeps references.
  ContactFinder(const Scene& scene, const SceneGeometry& geometry, const Vector3& gravity,
                const ContactConfiguration& refinements = {});

  /// Every step: replaces `contacts` (sorted by key) by those of now. Contacts that last keep their memory;
  /// see god_object.h.
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
  void find_touch(const TouchingPair& pair, double step, double margin, const std::vector<Contact>& before);
  /// Closest features, in the shape's frame, at the time within the step at which the pair first touches, if
  /// it does.
  std::optional<ClosestFeatures> swept(const TouchingPair& pair, const PlacedCollider& collider, double step,
                                       double margin) const;
  void touch(const TouchingPair& pair, const ClosestFeatures& features, const AxisSpan& span,
             const std::vector<Contact>& before);

  const Scene& scene_;
  const SceneGeometry& geometry_;
  const Vector3 gravity_;
  const ContactConfiguration refinements_;
  std::vector<Contact> found_;
  std::size_t found_count_ = 0;
  const Contact* memory_ = nullptr;  // in the last step, from those of the pair at hand on
};

}  // namespace mrhi
