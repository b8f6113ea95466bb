#pragma once

#include <algorithm>
#include <cmath>

#include "mr_hand_interaction/collision/contact.h"
#include "mr_hand_interaction/response/penetration_force.h"

namespace mrhi {

/// The spring of one contact as the implicit model solves it: where its two ends will be at the end of the
/// step, as a function of their relative velocity then. Body 1 is the hand, or body a; forces are on body 2,
/// the object, or body b. World axes, n from 2 to 1.
struct SpringContact {
  // At the step's start.
  Vector3 normal;
  Vector3 stretch;  ///< of the spring along the surface: end on 1 less end on 2 [m]
  double depth;     ///< [m]
  double twist;     ///< turn of 1 about n against 2, as far as it is held [rad]
  double patch;     ///< radius of the touching patch [m]

  // What it is made of.
  double step;             ///< [s]
  double ahead;            ///< how far ahead the spring is evaluated: the step, and what damping adds [s]
  double stiffness;        ///< [N/m]
  double twist_stiffness;  ///< [N m/rad], 0: a point that turns freely
  double friction;         ///< Coulomb's coefficient: static while sticking, dynamic while slipping
  double dynamic_friction;
  Friction before;

  // Coulomb's limits, by the normal force of the last iterate.
  double slip_limit = 0.0;   ///< [N]
  double twist_limit = 0.0;  ///< [N m]

  /// What acts at a relative velocity `u` of 1 at the contact point and a relative spin about n.
  struct Response {
    Vector3 force;  ///< [N]
    double torque;  ///< about n [N m]
    double push;    ///< normal part of the force, >= 0 [N]
    // -d force / d velocity of 2 is along (1 - n n') + across n n' - slip d d', symmetric, >= 0 [N s/m].
    double across;
    double along;
    double slip;
    Vector3 direction;    ///< d, unit, of the sliding
    double torque_slope;  ///< -d torque / d spin of 2 [N m s]
  };
  /// What is kept in the contact's memory at the end of the step.
  struct Settled {
    Vector3 force;
    Friction friction;
    Vector3 slide;  ///< by how much 2's end has to follow along the surface [m]
    double twist;
  };

  void limit_friction(const Vector3& u);
  Response evaluate(const Vector3& u, double spin) const;
  /// Convex function of the velocities whose gradient gives the response [W].
  double potential(const Vector3& u, double spin) const;
  Settled settle(const Vector3& u, double spin) const;

  bool acts(const Response& response) const { return response.push > 0.0 || slip_limit > 0.0; }

 private:
  double depth_ahead(double rate) const { return std::max(0.0, depth - ahead * rate); }
  double push(double rate) const {
    return stiffness * depth_ahead(rate) * std::clamp(1.0 - rate / kReleaseSpeed, 0.0, 1.0);
  }
  Vector3 stretch_ahead(const Vector3& u) const { return stretch + ahead * (u - normal.dot(u) * normal); }
};

inline void SpringContact::limit_friction(const Vector3& u) {
  constexpr double kPatchTorque = 2.0 / 3.0;  // of mu N a: a patch of radius a that presses evenly
  const double force = push(normal.dot(u));
  slip_limit = friction * force;
  twist_limit = kPatchTorque * slip_limit * patch;
}

inline SpringContact::Response SpringContact::evaluate(const Vector3& u, double spin) const {
  const double rate = normal.dot(u);
  const double deep = depth_ahead(rate);
  Response response;
  response.push = push(rate);
  response.across = 0.0;
  if (deep > 0.0 && rate < kReleaseSpeed) {
    response.across = rate <= 0.0 ? stiffness * ahead
                                  : stiffness * (ahead * (1.0 - rate / kReleaseSpeed) + deep / kReleaseSpeed);
  }
  response.force = -response.push * normal;

  const Vector3 drawn = stretch_ahead(u);
  const double length_squared = drawn.squaredNorm();
  response.slip = 0.0;
  if (stiffness * stiffness * length_squared <= slip_limit * slip_limit) {
    response.force += stiffness * drawn;
    response.along = slip_limit > 0.0 ? stiffness * ahead : 0.0;
  } else {
    const double length = std::sqrt(length_squared);
    response.direction = drawn / length;
    response.force += slip_limit * response.direction;
    response.along = response.slip = slip_limit * ahead / length;
  }

  const double wanted = twist_stiffness * (twist + ahead * spin);
  response.torque = std::clamp(wanted, -twist_limit, twist_limit);
  response.torque_slope = std::abs(wanted) < twist_limit ? twist_stiffness * ahead : 0.0;
  return response;
}

}  // namespace mrhi
