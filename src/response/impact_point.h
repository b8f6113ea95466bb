#pragma once

#include <array>

#include "mr_hand_interaction/collision/body_contact.h"
#include "mr_hand_interaction/collision/contact.h"
#include "mr_hand_interaction/integration/body_state.h"
#include "mr_hand_interaction/scene/body.h"
#include "mr_hand_interaction/tracking/hand_track.h"

namespace mrhi {

/// How the joint velocities of an island move one contact point, and how an impulse there changes them.
struct JointCoordinates {
  Eigen::Matrix<double, 3, Eigen::Dynamic> jacobian;  ///< velocity of the point for unit joint velocities
  Eigen::Matrix<double, Eigen::Dynamic, 3> response;  ///< M^-1 J': joint velocities for a unit impulse
  Eigen::VectorXd* velocity;                          ///< of the island's joints, which the impulses change
};

/// How far impacts have slowed each capsule of the hands [m/s]: the points of a capsule share its mass.
class HandRecoils {
 public:
  /// Returns that of the contact's capsule, at rest.
  Vector3* begin(const ContactKey& key) {
    Vector3& recoil = recoils_[std::size_t(key.hand) * kCapsules + key.capsule];
    recoil.setZero();
    return &recoil;
  }

 private:
  std::array<Vector3, kMaxHands * kCapsules> recoils_;
};

/// One contact point of an impact: two surfaces that collide, or may, within a step.
struct ImpactPoint {
  /// One of the two sides. A fixture has nothing set, and no impulse moves it. A hand has its inverse mass
  /// and its capsule's recoil; the tracked hand itself moves on. A body on joints has its coordinates.
  struct Partner {
    BodyState* state = nullptr;
    const JointCoordinates* joints = nullptr;
    double inverse_mass = 0.0;
    Vector3* recoil = nullptr;  // of the hand's capsule in this impact
    Matrix3 inverse_inertia;    // world axes
    Vector3 arm;                // from the centre of mass [m]

    Vector3 velocity_of_centre() const;
    Vector3 velocity() const;
    void apply(const Vector3& impulse);  // [N s]
    Matrix3 inverse_effective_mass() const;
  };
  /// The second surface is that of b. On joints, b stands for the motion of both against each other.
  Partner a, b;
  bool by_hand = false;
  Vector3 hand_velocity = Vector3::Zero();  // of the hand's point, which takes the place of a [m/s]
  double restitution = 0.0;
  double friction = 0.0;           // Coulomb's coefficient
  double acceleration = 0.0;       // of the rate n.(c1' - c2'), by gravity [m/s^2]
  double radius_a = 0.0;           // of a free ball; 0 for others [m]
  double radius_b = 0.0;           // likewise
  BodyContact* between = nullptr;  // the contact, if it is one of two bodies
  Vector3* total = nullptr;        // sum of impulses that the contact reports, if there is a contact
  bool* struck = nullptr;          // the contact's mark that its approach is over

  // Where the surfaces are at `time`.
  double time = 0.0;  // from the step's start; finally the time of impact [s]
  double gap = 0.0;   // [m]
  Vector3 normal;     // from b to a

  // The impact.
  Vector3 approach;                            // relative velocity before it [m/s]
  double target = 0.0;                         // rate after it, as it would be at the step's start [m/s]
  Vector3 normal_response;                     // of the relative velocity to a unit impulse along n [1/kg]
  double normal_mass = 0.0;                    // effective [kg]
  double normal_impulse = 0.0;                 // accumulated [N s]
  double tangential_mass = 0.0;                // likewise, of any tangential direction at least [kg]
  Vector3 friction_impulse = Vector3::Zero();  // accumulated, on b [N s]

  Vector3 relative_velocity() const { return hand_velocity + a.velocity() - b.velocity(); }
  /// The same at the time of impact, with gravity's part along n.
  Vector3 velocity_on_impact() const { return relative_velocity() + time * acceleration * normal; }
  /// Rate of the gap, without gravity's part since the step's start [m/s].
  double rate() const { return normal.dot(relative_velocity()); }
  /// The normal of two balls turns as they pass each other.
  bool is_of_balls() const { return radius_a > 0.0 && radius_b > 0.0; }
  bool same_pair(const ImpactPoint& other) const {
    return a.state == other.a.state && b.state == other.b.state;
  }

  /// When the surfaces collide as the bodies move now, from the step's start; infinite if never [s].
  double collision_time() const;
  /// Moves on to a time as the bodies move now.
  void advance_to(double later);

  /// Finds the effective masses. No impulse has been accumulated yet.
  void begin();
  /// Moves the rate towards its target by impulses that only push, and stops the sliding within Coulomb's
  /// disc. Returns the largest change of an impulse over the normal's effective mass [m/s].
  double relax();
  /// Accumulated impulse on b; a has received the opposite [N s].
  Vector3 impulse() const { return friction_impulse - normal_impulse * normal; }
  /// Takes the accumulated impulse back.
  void undo();
  /// Sets the accumulated impulse on b, and applies the difference.
  void set_impulse(const Vector3& impulse);
  /// Upper bound of the effective mass along the normal [kg].
  double max_normal_mass() const { return b.joints != nullptr ? normal_mass : 1.0 / b.inverse_mass; }

 private:
  void advance_arms(double seconds, double closed);
};

}  // namespace mrhi
