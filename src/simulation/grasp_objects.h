#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "../collision/contact_finder.h"
#include "mr_hand_interaction/configuration.h"
#include "mr_hand_interaction/response/grip.h"
#include "mr_hand_interaction/scene/scene.h"
#include "mr_hand_interaction/simulation_state.h"

namespace mrhi {

/// Largest cosine between the normals of opposite faces. A fingertip that taps a cube has the thumb beside
/// the adjacent face.
constexpr double kMaxOpposingCosine = -0.3;

/// True for the capsules that fingers close against: the palm with its metacarpals, or the thumb.
inline bool is_base(bool by_palm, int capsule) {
  if (by_palm) return capsule == kPalm || bone_of(capsule) == 0;
  return finger_of(capsule) == 0;
}

/// Opposing contacts of a hand that could hold an object between them. World.
struct OpposingContacts {
  double depth = 0.0;             ///< of the deeper contact [m]
  double squeeze = 0.0;           ///< sum of both depths [m]
  Vector3 base, fingers;          ///< points of contact
  bool by_palm = false;           ///< the base is the palm; false: the thumb
  std::size_t body = 0;           ///< that the base touches
  std::uint8_t fingers_mask = 0;  ///< a bit for each finger that opposes the base
};

/// Contact groups of a grip that touch its object.
struct TouchingGroups {
  bool base = false, fingers = false;

  bool both() const { return base && fingers; }
  bool none() const { return !base && !fingers; }
};

/// The objects that hands grasp, and how the contacts of a step hold them. All bodies of a floating linkage
/// are one object: a thumb on its base and a finger on its lid oppose each other.
class GraspObjects {
 public:
  /// Indices in Scene::bodies.
  using Object = std::vector<int>;
  using Contacts = std::vector<Contact>;

  /// Contact models other than `implicit` have no grips: their objects are all free.
  GraspObjects(const Scene& scene, const Configuration& configuration);

  /// True if an object is not free.
  bool any_graspable() const { return any_graspable_; }
  const Object& object_of(std::size_t body) const { return objects_[index_[body]]; }
  /// Free, assist or never.
  GraspMode mode_of(std::size_t body) const { return modes_[index_[body]]; }
  bool same_object(std::size_t a, std::size_t b) const { return index_[a] == index_[b]; }
  /// True if the hand has the body in this grip, or another part of the same object.
  bool is_in(const Grip& grip, std::size_t hand, std::size_t body) const {
    return grip.hand == hand && same_object(grip.body, body);
  }

  /// True if all fingers that touch the object take part in the grip.
  bool only_fingers_of(const Grip& grip, const Contacts& contacts) const;
  TouchingGroups touching_groups(const Grip& grip, const Contacts& contacts) const;
  /// True if contacts slip that carry more than half of the normal force of one of the grip's groups.
  bool slips(const Grip& grip, const Contacts& contacts) const;
  /// True if the same hand, or with `by_any_hand` any hand, touches the same object on a face opposite to
  /// this contact's, or will soon: contacts begin 1 mm before the surface.
  bool is_opposed(const Contact& contact, const Contacts& contacts, bool by_any_hand = false) const;
  /// True if a finger of the hand opposes its thumb or palm across the object.
  bool is_opposed(std::size_t hand, std::size_t body, bool by_palm, const Contacts& contacts) const;
  std::optional<OpposingContacts> opposing_contacts(std::size_t hand, std::size_t body, bool by_palm,
                                                    const Contacts& contacts) const;

 private:
  template <typename See>
  void each_opposed(std::size_t hand, std::size_t body, bool by_palm, const Contacts& contacts,
                    const See& see) const;

  std::vector<Object> objects_;
  std::vector<std::size_t> index_;      // by body, in objects_
  std::vector<double> friction_angle_;  // by body [rad]
  std::vector<GraspMode> modes_;        // of objects
  bool any_graspable_ = false;
};

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
  /// Distance from the object to one contact group of a grip, its base or its fingers: negative inside,
  /// limited [m].
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
