#pragma once

#include "mr_hand_interaction/integration/body_state.h"
#include "mr_hand_interaction/scene/joint.h"

namespace mrhi {

/// The joint's own forces as functions of its velocity at the step's end: spring, detents, latch, damping,
/// friction, limits. Each decreases with the velocity, so that the step's problem stays convex. Limits,
/// friction and the latch are springs ten thousand times as stiff as the joint's inertia within a step, the
/// last two up to their force: a held joint does not creep.
class JointLaw {
 public:
  /// `inertia`: of the joint alone, its entry of the mass matrix; `usual`: step, of which frames leave
  /// shorter ones over [s].
  void begin(const Joint& joint, const JointState& state, double inertia, double step, double usual);
  /// Takes down what a limit has given within this step already, when it was struck [N m s].
  void note_limit_impulse(double impulse) { blow_ += impulse; }

  /// Whether it gives anything up to this speed either way.
  bool acts(double speed) const;

  double force(double velocity) const;   ///< [N m]
  double slope(double velocity) const;   ///< -d force / d velocity, >= 0
  double energy(double velocity) const;  ///< whose slope is -force [W]
  /// Sum of the magnitudes of all forces that act [N m].
  double size(double velocity) const;

  /// Updates the joint's state once its velocity at the step's end is known.
  void settle(double velocity, JointState& state) const;

 private:
  /// A spring with the largest force `most`, whose end moves with the joint: stiffness * (stretch - step *
  /// velocity).
  struct Hold {
    double stiffness = 0.0, stretch = 0.0, most = 0.0;
    double wanted(double way) const { return stiffness * (stretch - way); }
    double force(double way) const;
    double slope(double way) const;
    double energy(double way) const;
  };
  /// The joint may not go further than `room`.
  struct Stop {
    double room = Joint::kUnlimited, sign = 1.0;
    double over(double way) const;
  };

  double constant_ = 0.0, linear_ = 0.0;  // force = constant - linear * velocity, of springs and damping
  Hold friction_, latch_;
  Stop lower_, upper_;
  double stop_ = 0.0;  // stiffness of what holds
  double blow_ = 0.0;
  double step_ = 0.0;
};

/// Events of a joint in a step.
struct JointChange {
  bool reached_limit = false, entered_detent = false, opened_latch = false;
};
JointChange note_place(const Joint& joint, JointState& state);

/// Initial state of a joint, at rest.
JointState start_state(const Joint& joint);

}  // namespace mrhi
