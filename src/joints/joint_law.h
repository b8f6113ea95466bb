#pragma once

#include "mr_hand_interaction/integration/body_state.h"
#include "mr_hand_interaction/scene/joint.h"

namespace mrhi {

/// Forces of a joint as functions of its velocity at the end of the step: spring, detents, latch, damping,
/// friction, limits. Each decreases as the velocity grows, so the step's problem stays convex. Limits,
/// friction and latch are springs, ten thousand times as stiff as the joint's inertia per squared step.
/// Friction and latch have a force limit; up to it a held joint does not creep.
class JointLaw {
 public:
  /// `inertia`: the joint's diagonal entry of the mass matrix; `regular_step`: the last step of
  /// a frame may be shorter [s].
  void begin(const Joint& joint, const JointState& state, double inertia, double step, double regular_step);
  /// Records the impulse of a limit in an impact of this step [N m s].
  void note_limit_impulse(double impulse) { limit_impulse_ += impulse; }

  /// True if any force acts at speeds up to this one, in either direction.
  bool acts(double speed) const;

  double force(double velocity) const;   ///< [N m]
  double slope(double velocity) const;   ///< -d force / d velocity, >= 0
  double energy(double velocity) const;  ///< its slope is -force [W]
  /// Sum of the magnitudes of limits, holds and springs [N m].
  double size(double velocity) const;

  /// Updates the joint's state for the velocity at the end of the step.
  void settle(double velocity, JointState& state) const;

 private:
  /// A spring with a force limit, whose end moves with the joint: stiffness * (stretch - step *
  /// velocity).
  struct YieldingSpring {
    double stiffness = 0.0, stretch = 0.0, max_force = 0.0;
    double elastic_force(double travel) const { return stiffness * (stretch - travel); }
    double force(double travel) const;
    double slope(double travel) const;
    double energy(double travel) const;
  };
  /// A limit; its clearance is that of the position at the start of the step.
  struct LimitSpring {
    double clearance = Joint::kUnlimited, sign = 1.0;
    double penetration(double travel) const;
  };

  double constant_ = 0.0, linear_ = 0.0;  // force of springs and damping = constant - linear * velocity
  YieldingSpring friction_, latch_;
  LimitSpring lower_, upper_;
  double stop_ = 0.0;  // stiffness of limits and holds
  double limit_impulse_ = 0.0;
  double step_ = 0.0;
};

/// Changes of a joint's position that cause events.
struct JointChange {
  bool reached_limit = false, entered_detent = false, opened_latch = false;
};
JointChange note_place(const Joint& joint, JointState& state);

/// Start position, at rest.
JointState start_state(const Joint& joint);

}  // namespace mrhi
