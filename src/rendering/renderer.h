#pragma once

#include <array>
#include <vector>

#include "../collision/contact_finder.h"
#include "mr_hand_interaction/collision/contact.h"
#include "mr_hand_interaction/interaction.h"
#include "mr_hand_interaction/rendering/rendered_hand.h"
#include "mr_hand_interaction/simulation.h"
#include "mr_hand_interaction/tracking/hand_track.h"

namespace mrhi {

/// How far joints go, active and passive, rounded outwards to 5 degrees: Kapandji, The Physiology of the
/// Joints, vol. 1; Norkin & White, Measurement of Joint Motion [rad]. Order as in FingerOffset.
struct JointLimits {
  FingerOffset lower, upper;
};

/// Limits of a finger. Thumb: the carpometacarpal joint relative to a rest pose, then metacarpophalangeal and
/// interphalangeal.
JointLimits joint_limits(int finger);

/// Zero direction of a finger's root joint, and the axis about which it flexes. Unit, at right angles.
struct RootFrame {
  Vector3 along, hinge;
};
/// Rest pose of the thumb's metacarpal in the palm of a right hand (x to the fingers, z out of the back).
const RootFrame& thumb_rest();

/// A tracked finger as a chain: a root joint that flexes and abducts, fixed to the palm, and two hinges.
/// Joints are turned from where they were tracked, so that bones keep their lengths whatever the offset. All
/// in world.
///
/// Axes are lines fixed to bones: root_ stays with the palm, swing_ is turned by the root's flexion, hinge_
/// by both. Angles are signed by the right-hand rule about them.
class FingerChain {
 public:
  FingerChain() = default;
  /// Places the finger without an offset of its own. If the palm lags, `lags_behind` is the tracked hand.
  FingerChain(const Hand& tracked, int finger, const Vector3& shift, const Hand* lags_behind = nullptr);

  /// Places the finger's phalanges, its joints turned by `offset` and all shifted by `shift`.
  void place(const Hand& tracked, const FingerOffset& offset, const Vector3& shift, Hand& placed);
  /// The offset with which the finger points as in `shown`, which `chain` placed, within its limits. Zero for
  /// a finger that is not connected to the palm.
  FingerOffset like(const Hand& shown, const FingerChain& chain) const;
  /// The same without regard to limits.
  FingerOffset pointing(const Hand& shown, const FingerChain& chain) const;
  /// Derivative of n.x by the offset, with x a point of bone 1 to 3 as last placed.
  FingerOffset gradient(int bone, const Vector3& x, const Vector3& n) const;
  /// Upper bound of the joints' displacements for a change of the offset [m].
  double displacement(const FingerOffset& change) const;

  /// Turn of each joint that moves the tip by about `distance` [m].
  FingerOffset swing(double distance) const;

  /// Bounds of the offset: they keep every joint in its limits, widened to its tracked angle. They contain 0
  /// unless the palm lags.
  const FingerOffset& lower() const { return lower_; }
  const FingerOffset& upper() const { return upper_; }
  /// Compliance of each component.
  FingerOffset compliance() const;

 private:
  void find_axes(const Hand& tracked);
  void find_limits(const Hand& tracked, const Hand* lags_behind);
  FingerOffset angles(const Hand& hand, const Vector3& hinge) const;
  bool has(const Hand& hand, int bone) const { return hand.has(capsule_index(finger_, bone)); }
  const Capsule& bone(const Hand& hand, int index) const {
    return hand.capsules[capsule_index(finger_, index)];
  }

  int finger_ = 0;
  bool tied_ = false;                            // to the palm: it has a proximal phalanx
  Vector3 onward_;                               // from where the root's angles count; unit
  Vector3 root_, swing_, hinge_;                 // axes of root flexion, abduction and the hinges; unit
  Vector3 placed_swing_, placed_hinge_;          // the same as last placed
  std::array<Vector3, kBonesPerFinger> joints_;  // start of each bone as last placed
  FingerOffset lower_, upper_;                   // see lower()
  FingerOffset reach_;                           // from each joint to the tip [m]
  FingerOffset angles_;                          // of the joints as tracked [rad]
};

/// Compliance of the whole hand, relative to that of its joints (FingerChain::compliance).
constexpr double kShiftCompliance = 0.3;

/// A tracked hand as a palm, which can be shifted, and five fingers on it. The chain of a finger is created
/// on first use: most fingers touch nothing.
class HandChain {
 public:
  /// Keeps a reference.
  void begin(const Hand& tracked, const PalmLag& lag = PalmLag());

  /// The hand with its offset, which keeps within limits from here on.
  void place(const HandOffset& offset, Hand& placed);
  /// A finger, as last placed.
  FingerChain& finger(int index);

  /// Where a capsule moves by itself: its finger, or none if it moves with the palm.
  static int finger_that_moves(int capsule) {
    return capsule == kPalm || bone_of(capsule) == 0 ? -1 : finger_of(capsule);
  }

 private:
  const Hand* tracked_ = nullptr;
  const Hand* lags_behind_ = nullptr;
  Hand turned_;                      // what tracked_ is where the palm lags
  Vector3 shift_ = Vector3::Zero();  // as last placed
  std::array<FingerChain, kFingers> fingers_;
  std::array<bool, kFingers> known_{};
};

/// A point of a capsule's axis that must keep off a plane by the capsule's radius. gap = normal.a(s) - height
/// - radius, with normal.x = height the plane: linear in the axis's point a(s).
struct Clearance {
  ContactKey key{};                   ///< the capsule, the shape, and which end of a stretch that lies flat
  double s = 0.0;                     ///< axis parameter of the point
  Vector3 normal = Vector3::UnitZ();  ///< of the plane, out of the shape
  double height = 0.0;                ///< of the plane along its normal [m]
  double gap = 0.0;                   ///< as the hand is placed; < 0 is too deep [m]

  // How the gap changes with the offset, and what keeps it from closing.
  Eigen::Array4d by_shift = Eigen::Array4d::Zero();  ///< 3 and 0
  FingerOffset by_finger = FingerOffset::Zero();
  double rest = 0.0;      ///< gap at offset 0, linearised [m]
  double pressure = 0.0;  ///< Lagrange multiplier, >= 0
};

/// A tracked hand at a frame, and its surroundings.
struct HandFrameView {
  const HandTrack& track;
  int slot;
  Nanoseconds stamp;
  const std::vector<BodyState>& bodies;
  const std::vector<Contact>& contacts;  ///< the present ones, with the faces that phalanges entered by
  Interaction* interactions;             ///< the hand's, one per body: `shown_in` is cleared by the renderer
  const Hand* shown_before = nullptr;    ///< in the previous frame, if the hand was there
  double moved = 0.0;                    ///< bound of the relative displacement since then [m]
};

/// Finds where a hand to be shown is near or inside bodies, and on which side of them it is.
class ClearanceFinder {
 public:
  /// Up to this depth the nearest surface is the one that the hand has entered by [m].
  static constexpr double kMaxShallowDepth = 0.002;

  /// Keeps references.
  ClearanceFinder(const Scene& scene, const ContactFinder& finder) : scene_(scene), finder_(finder) {}

  /// Collects the bodies within `margin` of the tracked hand [m], except those that it is shown in. False if
  /// there are none. Keeps a reference until the next call.
  bool begin(const HandFrameView& view, double margin);

  /// True if a body that the hand is shown in is near it.
  bool shown_in_any() const { return !shown_in_.empty(); }
  /// Clears `shown_in` of the bodies that the hand, as shown before, is clear of.
  void end_shown_in(const Hand& shown) const;

  /// Largest speed of any point of the bodies near the hand [m/s].
  double fastest_body() const;
  /// Velocity of a point of a body [m/s].
  Vector3 velocity(int body, const Vector3& point) const;

  /// Adds surfaces near the placed hand to `clearances`, before it meets them, and updates the gaps of all.
  /// Returns the smallest gap [m], at most kLookAhead.
  double find(const Hand& placed, std::vector<Clearance>& clearances) const;

  /// True if the body never moves.
  bool fixed(int body) const { return scene_.bodies[body].fixed; }
  /// True if no capsule of the hand is in any of the bodies.
  bool clear(const Hand& hand) const;

 private:
  struct Near {
    int body, shape;
    ContactFinder::PlacedFrame frame;
    Vector3 centre;
    double radius;  // of a sphere about the centre that holds the body [m]
  };
  struct Face {
    Vector3 normal, point;
    double s0, s1;
  };
  template <typename See>
  static void each_near(const std::vector<Near>& near, const Hand& hand, double margin, const See& see);
  Face face(const Hand& placed, int capsule, const Near& near, const ClosestFeatures& features,
            const AxisSpan& span) const;

  const Scene& scene_;
  const ContactFinder& finder_;
  const HandFrameView* view_ = nullptr;
  std::vector<Near> near_, shown_in_;
};

class Pace;  ///< limits the joints' displacement in a frame

constexpr double kClearDepth = 2e-5;  ///< up to this depth a capsule counts as clear [m]
constexpr double kMaxDepth = 1e-4;    ///< largest depth of a solution [m]
constexpr double kMaxPaceDepth =
    1.8e-4;  ///< the same if only that limits the pace; below the promised 0.2 mm [m]
constexpr double kLookAhead = 0.0015;  ///< surfaces within this distance are avoided before they are met [m]

/// Shows a tracked hand outside all bodies as one connected hand: its bones as tracked, turned about its
/// joints within their limits, and where that is not enough shifted as a whole. docs/pipeline.md.
class HandRenderer {
 public:
  /// Keeps references.
  HandRenderer(const Scene& scene, const ContactFinder& finder) : finder_(scene, finder) {
    clearances_.reserve(256);
  }

  /// Renders the hand. `offset` is the hand's of the previous frame, and is updated.
  void render(HandFrameView& view, HandOffset& offset, RenderedHand& rendered);

 private:
  bool begin();
  void keep_outside(bool near);
  bool show_in(bool fixtures) const;
  void look_back();
  void place_before();
  // `reference` is the offset to stay near to; `swing` bounds a fingertip's turn in the frame [m].
  void move_outside(double min_gap);
  void limit_pace(const HandOffset& reference);
  void keep_out(const HandOffset& reference, double swing);
  double settle(const HandOffset& reference, double swing, const Pace* pace = nullptr,
                double tolerated = kMaxDepth);
  double restart(const HandOffset& reference);
  double body_displacement() const;
  HandOffset staying(const PalmLag& lag);
  Quaternion frame_staying(const Quaternion& whole) const;
  PalmLag lag_staying();
  double limit_displacement(const PalmLag& lag);
  void shift_out();
  void trace_out();
  double displacement(const HandOffset& from, const HandOffset& to);
  bool left_behind();

  /// A hand as it was shown, and what it was placed from.
  struct Shown {
    Hand tracked, hand;
    HandOffset offset;
  };

  ClearanceFinder finder_;
  HandChain chain_, chain_before_;  // the latter as of the previous frame
  std::array<Shown, kMaxHands> shown_;
  std::vector<Clearance> clearances_;

  // Of the frame. `offset_` is the unknown, `placed_` the hand with it.
  HandFrameView* view_ = nullptr;
  const HandOffset* last_ = nullptr;  // the offset of the frame before
  HandOffset offset_;
  Hand* placed_ = nullptr;
  Hand before_;              // as it was shown at the frame before
  bool penetrates_ = false;  // bodies are in the way
  double leap_ = 0.0;        // of a joint beyond the displacement of hand and bodies, if unavoidable [m]
  double tracked_displacement_ = 0.0;  // of the farthest joint since then [m]
  double elapsed_ = 0.0;               // since then [s]
};

/// Sets which capsules touch, and with what force, from the contacts of the hand in `slot`.
void note_touches(const std::vector<Contact>& contacts, int slot, RenderedHand& rendered);

/// Deepest penetration of any of the hand's capsules into any body, but for those that it is shown in
/// (`interactions`, as in HandFrameView) [m], >= 0. Looks at the hand as it is: it shares nothing with what
/// made it.
double deepest_penetration(const Hand& hand, const ContactFinder& finder, const Scene& scene,
                           const std::vector<BodyState>& bodies, const Interaction* interactions);

/// HandOffset::lag at `stamp`, after it has decayed since the previous frame. No joint moves in a frame by
/// more than a person would see as a jump.
PalmLag lag_returning(const HandOffset& offset, Nanoseconds stamp);

/// Longest displacement of a rendered hand by its MassLag [m]: the hand stays at what it holds.
constexpr double kMaxMassLag = 0.05;

/// Acceleration that a hand gives to what it moves, and the mass of that.
struct MovedMass {
  double mass = 0.0;                       ///< of all free bodies that it moves [kg]; 0: none
  Vector3 acceleration = Vector3::Zero();  ///< mean over the frame, by the hand alone [m/s^2]
};

/// By the forces and impulses that the result reports of the hand in `slot` over a frame of `seconds`. Bodies
/// on joints count with all of their linkage. Weight that the hand carries is no acceleration.
MovedMass moved_mass(int slot, double seconds, const Scene& scene, const Vector3& gravity,
                     const FrameResult& result);

/// Ratio of the tracked hand's displacement to that of the rendered hand, while it accelerates `mass` from
/// rest faster than the lag returns: from 1 without mass to `largest` for an infinite one.
double control_display_ratio(double largest, double mass);

/// The lag at `stamp`, after a frame in which the hand moved `moved`. In the frame the lag d obeys
///     d'' + 2 w d' + w^2 d = -(1 - 1 / r) a
/// with r the mass's control-to-display ratio, a its acceleration, and w the rate of the return.
void advance_mass_lag(double largest, const MovedMass& moved, Nanoseconds stamp, MassLag& lag);

/// The hand of a track as it lags: its poses in world at the frame's start and end, by the lags of then.
void lag_behind(const MassLag& before, const MassLag& now, const HandTrack& track, HandTrack& lagging);

}  // namespace mrhi
