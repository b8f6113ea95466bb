#pragma once

#include <vector>

#include "mr_hand_interaction/collision/body_contact.h"
#include "mr_hand_interaction/collision/contact.h"
#include "mr_hand_interaction/integration/body_state.h"
#include "mr_hand_interaction/scene/body.h"

namespace mrhi {

/// Inverse effective mass of a free body at the point `r` from its centre (Eq. 12; the tracked hand is
/// kinematic): K = I/m - [r]x I^-1 [r]x, symmetric positive definite [1/kg].
Matrix3 collision_matrix(double inverse_mass, const Matrix3& world_inverse_inertia, const Vector3& r);

/// Returns the largest eigenvalue of the symmetric matrix (tt ts; ts ss).
double max_eigenvalue(double tt, double ts, double ss);
/// Returns the largest eigenvalue of K perpendicular to the unit vector `n` [1/kg]; for n = 0 the trace,
/// which bounds all eigenvalues. Friction relaxed by its inverse does not overshoot in any direction.
double max_tangential_response(const Matrix3& k, const Vector3& n);

/// Changes the momenta of a body by `impulse` [N s] at `point` (Eq. 15 with its angular part).
void apply_impulse(const Vector3& impulse, const Vector3& point, BodyState& state);

/// Velocity of the hand's surface relative to the object's at the contact: c1' - c2' [m/s].
Vector3 relative_velocity(const Contact& contact, const Body& body, const BodyState& state);

/// An energy gain below this fraction of the exchanged energy is rounding.
constexpr double kGainTolerance = 1e-7;

/// A point of an impact under two laws, Newton's and one without restitution: impulses on the second body
/// [N s], and the first surface's velocity relative to the second before and after the impact [m/s].
struct ImpactLaws {
  Vector3 approach, newtons, after_newtons, plastic, after_plastic;
};

/// Returns the energy that the bodies gain in an impact beyond the work of the hands [J].
double energy_gained(const Vector3& approach, const Vector3& impulse, const Vector3& after);

/// Limits an impact to one that gains no energy, which restitution and friction together may do (Kane &
/// Levinson, Dynamics, 1985). Blends `newtons` towards the impact without restitution, which only dissipates.
/// If that gains energy too, where joints jam and no solution was found, blends towards no impact.
void keep_from_gaining(std::vector<ImpactLaws>& points);

/// First time from now at which a gap [m] with the given `rate` [m/s] and `acceleration` [m/s^2] closes; 0 if
/// it is closed already, infinite if never [s].
double time_to_close(double gap, double rate, double acceleration);

/// Eq. 8 sorted: v = n.(c1' - c2') [m/s], < 0 approaches.
Approach classify(double normal_velocity);

/// Velocity of the object's point c in world (Eq. 7) [m/s].
Vector3 object_velocity(const Twist& twist, const Vector3& centre, const Vector3& point);

/// Effect of joint velocities on one contact point of an island, and of an impulse there on them.
struct JointCoordinates {
  Eigen::Matrix<double, 3, Eigen::Dynamic> jacobian;  ///< velocity of the point for unit joint velocities
  Eigen::Matrix<double, Eigen::Dynamic, 3> response;  ///< M^-1 J': joint velocities for a unit impulse
  Eigen::VectorXd* velocity;                          ///< of the island's joints; impulses change it
};

/// A contact point of an impact: two surfaces that collide or may collide within a step.
struct ImpactPoint {
  /// One of the two bodies. A fixture has no members set, and impulses have no effect. A hand has its inverse
  /// mass and its capsule's recoil; the tracked hand itself moves on. A jointed body has joint coordinates.
  struct Partner {
    BodyState* state = nullptr;
    const JointCoordinates* joints = nullptr;
    double inverse_mass = 0.0;
    Vector3* recoil = nullptr;   // of the hand's capsule in this impact
    Matrix3 inverse_inertia;     // world axes
    const Body* body = nullptr;  // of a state
    Quaternion orientation;      // of a state, at `inertia_time`
    Vector3 arm;                 // from the centre of mass [m]

    Vector3 velocity_of_centre() const;
    // Inline for relax(), which is most of an impact's cost. Only a free body has a state: neither a hand nor
    // a body with joints.
    //
    //     v + w x r (Eq. 7), or J u. The hand's own velocity is `hand_velocity`.
    [[gnu::always_inline]] Vector3 velocity() const {
      if (state != nullptr)
        return inverse_mass * state->linear_momentum + (inverse_inertia * state->angular_momentum).cross(arm);
      if (joints != nullptr) return joints->jacobian * *joints->velocity;
      return recoil != nullptr ? *recoil : Vector3(Vector3::Zero());
    }
    /// An impulse [N s].
    [[gnu::always_inline]] void apply(const Vector3& impulse) {
      if (state != nullptr) {
        state->linear_momentum += impulse;
        state->angular_momentum += arm.cross(impulse);
      } else if (joints != nullptr) {
        joints->velocity->noalias() += joints->response * impulse;
      } else if (recoil != nullptr) {
        *recoil += inverse_mass * impulse;
      }
    }
    Matrix3 inverse_effective_mass() const;
  };
  /// The second surface is that of b. With joints, b stands for the relative motion of both.
  Partner a, b;
  bool by_hand = false;
  Vector3 hand_velocity = Vector3::Zero();  // velocity of the hand's point, in place of a's [m/s]
  double restitution = 0.0;
  double friction = 0.0;           // Coulomb's coefficient
  double acceleration = 0.0;       // gravity's contribution to the rate n.(c1' - c2') [m/s^2]
  double radius_a = 0.0;           // of a free ball; 0 for others [m]
  double radius_b = 0.0;           // likewise
  BodyContact* between = nullptr;  // the contact, if it is between two bodies
  Vector3* total = nullptr;        // the contact's reported sum of impulses; null without a contact
  bool* struck = nullptr;          // the contact's flag that its approach has ended

  // State at `time`.
  double time = 0.0;          // from the start of the step; finally the time of impact [s]
  double gap = 0.0;           // [m]
  Vector3 normal;             // from b to a
  double inertia_time = 0.0;  // of the inverse inertia, from the start of the step [s]

  // Impact.
  Vector3 approach;                            // relative velocity before the impact [m/s]
  double target = 0.0;                         // rate after it, extrapolated to the step's start [m/s]
  Vector3 normal_response;                     // relative velocity by a unit impulse along n [1/kg]
  double normal_mass = 0.0;                    // effective [kg]
  double normal_impulse = 0.0;                 // accumulated [N s]
  double tangential_mass = 0.0;                // lower bound over all tangential directions [kg]
  Vector3 friction_impulse = Vector3::Zero();  // accumulated, on b [N s]

  Vector3 relative_velocity() const { return hand_velocity + a.velocity() - b.velocity(); }
  /// Relative velocity at the time of impact, with gravity's contribution along n [m/s].
  Vector3 velocity_on_impact() const { return relative_velocity() + time * acceleration * normal; }
  /// Rate of the gap, without gravity's contribution since the start of the step [m/s].
  double rate() const { return normal.dot(relative_velocity()); }
  /// True if both are balls: their normal rotates as they pass each other.
  bool is_of_balls() const { return radius_a > 0.0 && radius_b > 0.0; }
  bool same_pair(const ImpactPoint& other) const {
    return by_hand == other.by_hand && a.state == other.a.state && b.state == other.b.state;
  }
  bool shares_body(const ImpactPoint& other) const {
    const auto has = [&other](const BodyState* state) {
      return state != nullptr && (state == other.a.state || state == other.b.state);
    };
    return has(a.state) || has(b.state);
  }

  /// Time of collision under the present motion, from the start of the step; infinite if never [s].
  double collision_time() const;
  /// Advances to a time under the present motion.
  void advance_to(double later);
  /// Rotates the bodies' inertia to `time`, as they rotate until they are hit. Call for all points of a body
  /// whenever it is hit.
  void turn_inertia();

  /// Computes the effective masses and clears the accumulated impulse.
  void begin();
  /// Moves the rate towards its target by impulses that never pull, and reduces sliding within Coulomb's
  /// disc. Returns the largest change of an impulse over the normal's effective mass [m/s].
  double relax();
  /// Accumulated impulse on b; a has received the opposite [N s].
  Vector3 impulse() const { return friction_impulse - normal_impulse * normal; }
  /// Removes the accumulated impulse from the bodies.
  void undo();
  /// Sets the accumulated impulse on b, and applies the difference.
  void set_impulse(const Vector3& impulse);
  /// Upper bound of the effective mass along the normal [kg].
  double max_normal_mass() const { return b.joints != nullptr ? normal_mass : 1.0 / b.inverse_mass; }

 private:
  void advance_arms(double seconds, double closed);
};

}  // namespace mrhi
