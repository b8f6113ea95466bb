#pragma once

#include "mr_hand_interaction/collision/contact.h"
#include "mr_hand_interaction/integration/body_state.h"
#include "mr_hand_interaction/scene/material.h"

namespace mrhi {

/// A contact as the implicit model solves it: the spring between god object and phalanx where both will be at
/// the end of the step, as a function of the object's velocity then. World axes.
class ImplicitContact {
 public:
  ImplicitContact(Contact& contact, const Material& material, bool torsion, const Vector3& centre,
                  double step);

  /// Sets Coulomb's limits by the normal force at this velocity of the object (linear [m/s], angular
  /// [rad/s]).
  void limit_friction(const Vector3& linear, const Vector3& angular);

  /// What acts on the object at this velocity, within the limits set last, and how steeply it falls.
  struct Response {
    Vector3 force;        ///< [N]
    Matrix3 force_slope;  ///< -d force / d velocity of the contact point [N s/m], symmetric, >= 0
    double torque;        ///< about n [N m]
    double torque_slope;  ///< -d torque / d spin about n [N m s], >= 0
    double push;          ///< normal part of the force, >= 0 [N]
  };
  Response evaluate(const Vector3& linear, const Vector3& angular) const;

  /// Convex function of the velocity whose gradient is minus the response [W].
  double potential(const Vector3& linear, const Vector3& angular) const;

  /// Writes force, stick or slip and the dragged god object back, at the solution.
  void finish(const Vector3& linear, const Vector3& angular, const BodyState& state);

  bool rubs() const { return slip_limit_ > 0.0; }
  const Vector3& arm() const { return arm_; }
  const Vector3& normal() const { return normal_; }

 private:
  Vector3 relative_velocity(const Vector3& linear, const Vector3& angular) const;
  double depth_ahead(double normal_velocity) const;
  double push(double normal_velocity) const;
  Vector3 stretch_ahead(const Vector3& relative) const;
  double twist_ahead(const Vector3& angular) const;

  Contact& contact_;
  Vector3 normal_, arm_, stretch_;
  double step_;             // [s]
  double ahead_;            // how far ahead the spring is evaluated: the step, and what damping adds [s]
  double stiffness_;        // [N/m]
  double twist_stiffness_;  // [N m/rad]
  double friction_;         // coefficient: static while sticking, dynamic while slipping
  double dynamic_friction_;
  double slip_limit_ = 0.0;   // [N]
  double twist_limit_ = 0.0;  // [N m]
};

}  // namespace mrhi
