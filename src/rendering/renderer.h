#pragma once

#include <vector>

#include "../collision/contact_finder.h"
#include "hand_renderer.h"
#include "mr_hand_interaction/collision/contact.h"
#include "mr_hand_interaction/interaction.h"
#include "mr_hand_interaction/rendering/rendered_hand.h"

namespace mrhi {

/// How far joints go, active and passive, rounded outwards to 5 degrees: Kapandji, The Physiology of the
/// Joints, vol. 1; Norkin & White, Measurement of Joint Motion [rad]. Order as in FingerOffset.
struct JointLimits {
  FingerOffset lower, upper;
};

/// Of the thumb: its carpometacarpal joint against a rest pose, then metacarpophalangeal and interphalangeal.
JointLimits joint_limits(int finger);

/// Rest pose of the thumb's metacarpal in the palm of a right hand (x to the fingers, z out of the back):
/// where it points, and the axis about which the thumb flexes. Unit, at right angles.
struct ThumbRest {
  Vector3 along, hinge;
};
const ThumbRest& thumb_rest();

/// A tracked finger as a chain: a root joint that flexes and abducts, fixed to the palm, and two hinges.
/// Joints are turned from where they were tracked, so that bones keep their lengths whatever the offset. All
/// in world.
///
/// Axes are lines fixed to bones: root_ stays with the palm, swing_ is turned by the root's flexion, hinge_
/// by both. Angles are signed by the right-hand rule about them.
class FingerChain {
 public:
  FingerChain() = default;
  /// As placed with no offset of its own. Where the palm lags, `lags_behind` is the hand as it was tracked.
  FingerChain(const Hand& tracked, int finger, const Vector3& shift, const Hand* lags_behind = nullptr);

  /// Places the finger's phalanges, its joints turned by `offset` and all shifted by `shift`.
  void place(const Hand& tracked, const FingerOffset& offset, const Vector3& shift, Hand& placed);
  /// The offset that lets the finger point as it does in `shown`, which `chain` placed, as far as its limits
  /// allow. Of a finger that nothing ties to the palm: none.
  FingerOffset like(const Hand& shown, const FingerChain& chain) const;
  /// The same without regard to limits.
  FingerOffset pointing(const Hand& shown, const FingerChain& chain) const;
  /// By how much n.x grows with each component of the offset, x a point of bone 1 to 3 as last placed.
  FingerOffset gradient(int bone, const Vector3& x, const Vector3& n) const;
  /// No joint of the finger moves farther than this for a change of the offset [m].
  double way(const FingerOffset& change) const;

  /// How far each joint may turn while the tip moves about as far as `way` [m].
  FingerOffset swing(double way) const;

  /// Offsets that leave every joint in its limits or, if it was tracked beyond one, let it go no farther. 0
  /// is among them unless the palm lags.
  const FingerOffset& lower() const { return lower_; }
  const FingerOffset& upper() const { return upper_; }
  /// How readily each component gives way.
  FingerOffset compliance() const;

 private:
  void find_axes(const Hand& tracked);
  void find_limits(const Hand& tracked, const Hand* lags_behind);
  FingerOffset angles(const Hand& hand, const Vector3& hinge) const;
  bool has(const Hand& hand, int bone) const { return hand.has(capsule_index(finger_, bone)); }

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

/// How readily the whole hand gives way, beside its joints (FingerChain::compliance).
constexpr double kShiftCompliance = 0.3;

/// A tracked hand as a palm, which can be shifted, and five fingers on it. A finger's chain is made once it
/// is asked for: most of them touch nothing.
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

/// How far joints may go from where they were in the frame before: a fingertip no farther than `swing` [m].
struct OffsetBounds {
  const HandOffset& before;
  double swing;
};

/// The offset nearest to `reference`, measured by how readily things give way, that keeps all gaps at 0 or
/// more and all joints in their limits:
///   minimise 1/2 (q - q0)' W (q - q0)  subject to  gap + J (q - qk) >= 0,  lower <= q <= upper,
/// linearised where the hand is placed now (qk, in `offset`). Dual coordinate ascent (Hildreth 1957), with
/// the limits by clamping. Pressures are where it starts and are left as found. A joint goes at most a
/// quarter of a radian from where it is. Returns the least gap then, linearised [m].
double solve_offset(const HandOffset& reference, const OffsetBounds& bounds, HandChain& chain,
                    std::vector<Clearance>& clearances, HandOffset& offset);

/// Finds where a hand that is to be shown is near bodies, or in them, and on which side of them it stands.
class ClearanceFinder {
 public:
  /// Less deep than this the nearest way out is the way in [m].
  static constexpr double kShallow = 0.002;

  /// Keeps references.
  ClearanceFinder(const Scene& scene, const ContactFinder& finder) : scene_(scene), finder_(finder) {}

  /// Which hand it is, in which scene; `contacts` know the faces that its phalanges entered by.
  struct Setting {
    const Hand& tracked;
    int slot;
    const std::vector<BodyState>& bodies;
    const std::vector<Contact>& contacts;
    const Hand* shown_before;   ///< of the frame before, if the hand was there
    double moved;               ///< what hand and bodies have moved since [m]
    Interaction* interactions;  ///< of the hand, one per body: which of them it is shown in
  };
  /// Takes the bodies within `margin` of the tracked hand [m], but for those that it is shown in; false if
  /// there are none.
  bool begin(const Setting& setting, double margin);

  /// Of the bodies that the hand is shown in, some are near it.
  bool shown_in_any() const { return !shown_in_.empty(); }
  /// Ends this with those that the hand, as shown before, is clear of.
  void end_shown_in(const Hand& shown, Interaction* interactions) const;

  /// Of any point of the bodies near the hand [m/s].
  double fastest_body(const std::vector<BodyState>& bodies) const;

  /// Of a point of a body [m/s].
  Vector3 velocity(int body, const Vector3& point, const std::vector<BodyState>& bodies) const;

  /// Looks at the hand as placed: adds what is nearer than `margin` to `clearances`, and what is there
  /// already is measured anew. Returns the least gap [m], at most `margin`.
  double find(const Hand& placed, const Setting& setting, double margin,
              std::vector<Clearance>& clearances) const;

  /// A body that never moves.
  bool fixed(int body) const { return scene_.bodies[static_cast<std::size_t>(body)].fixed; }

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
            const AxisSpan& span, const Setting& setting) const;
  const Scene& scene_;
  const ContactFinder& finder_;
  std::vector<Near> near_;
  std::vector<Near> shown_in_;
};

class Pace;  ///< how far the joints may go in a frame

constexpr double kClear = 2e-5;      ///< gaps of more than -this are clear [m]
constexpr double kTolerated = 1e-4;  ///< a gap of less than -this is too deep once all is done [m]
constexpr double kDeepest = 1.8e-4;  ///< what is promised is 0.2 mm: where only that keeps pace [m]
constexpr double kAhead = 0.0015;    ///< surfaces nearer than this are kept off before they are met [m]

/// What a hand was shown like. Placing it anew gives the same bits: it is kept to be quick.
struct Shown {
  bool known = false;
  Hand tracked, hand;
  HandOffset offset;
};

/// What one hand's frame is made with, and what is kept between frames.
struct HandRenderer::Impl {
  Impl(const Scene& scene, const ContactFinder& contact_finder) : finder(scene, contact_finder) {
    clearances.reserve(256);
  }

  bool begin();
  void keep_outside(bool near);
  bool show_in(bool fixtures) const;
  void look_back();
  void place_before();
  FingerChain& finger_before(int index);
  // `reference` is the offset to stay near to; `swing` bounds a fingertip's turn in the frame [m].
  void push_out(double least);
  void keep_pace(const HandOffset& reference);
  void keep_out(const HandOffset& reference, double swing);
  double settle(const HandOffset& reference, double swing, const Pace* pace = nullptr,
                double tolerated = kTolerated);
  void begin_anew(const HandOffset& reference);
  double pushed_way() const;
  HandOffset staying(const PalmLag& lag);
  Quaternion frame_staying(const Quaternion& whole) const;
  PalmLag lag_staying();
  double held_by_limits(const PalmLag& lag);
  void linearise();
  void shift_out();
  void lead_out();
  double way(const HandOffset& from, const HandOffset& to);
  bool left_behind();

  // Of the frame. `offset` is what is looked for, `placed` the hand with it.
  ClearanceFinder::Setting* setting = nullptr;
  const HandTrack* track = nullptr;
  Nanoseconds stamp = 0;
  const HandOffset* last = nullptr;  // the offset of the frame before
  HandOffset offset;
  Hand* placed = nullptr;

  ClearanceFinder finder;
  HandChain chain;
  HandChain chain_before;         // set to the frame before once it is asked for
  bool chain_before_set = false;  // for this hand and frame
  std::vector<Clearance> clearances;
  Hand before;               // as it was shown at the frame before
  Hand tracked_before;       // and as it was tracked
  HandOffset offset_before;  // and its offset
  std::array<Shown, kMaxHands> kept;
  bool pushed = false;  // bodies are in the way
  double leap = 0.0;    // of a joint beyond what hand and bodies have moved, if there is no other way [m]
  double tracked_way = 0.0;  // of the farthest joint since then [m]
  double elapsed = 0.0;      // since then [s]
};

/// HandOffset::lag on its way back to none, from where it was at the frame before to `stamp`: it decays, and
/// no joint goes farther in one frame than a person would see as a jump.
PalmLag lag_returning(const HandOffset& offset, Nanoseconds stamp);

}  // namespace mrhi
