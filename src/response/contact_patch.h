#pragma once

#include <vector>

#include "spring_contact.h"

namespace mrhi {

/// Linear and angular velocity of a body, or the impulses that change them.
using Motion6 = Eigen::Matrix<double, 6, 1>;
using Mobility6 = Eigen::Matrix<double, 6, 6>;

/// A body of an island of several.
struct PatchBody {
  Motion6 motion;  // of the iterate, world axes
  double inverse_mass;
  Matrix3 inverse_inertia;  // world axes
};

/// On b: friction along u and v, the normal impulse against n [N s], and twist about n [N m s].
using PatchImpulses = Eigen::Vector4d;
enum { kNormal = 2, kTwist = 3 };

/// A contact in the form that sweeps use, in its patch's axes.
struct PatchPoint {
  PatchImpulses impulses;                   // accumulated
  Motion6 by_normal;                        // change of the relative motion by a unit normal impulse
  Eigen::Matrix<double, 6, 2> by_friction;  // likewise by unit friction along u and v
  Vector3 place;                            // of friction, from the patch's origin [m]
  double lever_u, lever_v;                  // r x n, the lever arm of the normal impulse about the origin [m]
  double normal_mobility;                   // change of the rate by a unit impulse along n [1/kg]
  NormalSpring spring;
  double closing;           // depth / e: the rate at which the depth is 0 after e [m/s]
  double compliance;        // 1 / (k e), along n [1/kg]
  double soft_stiffness;    // times the step, reduced by the bodies' mobility [N s/m]
  double kept, damping;     // factors of the last friction impulse and of the sliding in the next one
  Vector3 stretch_impulse;  // contribution of the stretch to it [N s]
  double friction, bond;
  bool nonlinear;  // true if the normal force is not proportional to depth

  double rate(const Motion6& m) const { return m[2] + lever_u * m[3] + lever_v * m[4]; }
  Eigen::Vector2d sliding(const Motion6& m) const {
    return {m[0] + m[4] * place.z() - m[5] * place.y(), m[1] + m[5] * place.x() - m[3] * place.z()};
  }
  /// Linear impulse on b.
  Vector3 impulse() const { return {impulses[0], impulses[1], -impulses[kNormal]}; }
  /// Adds all impulses, about the patch's origin.
  void add_impulses(Motion6& sum) const;
};

/// Contacts of one pair of shapes with one normal, relaxed together. A hand's contact is its own patch, and
/// so is a point of a grip. Its axes are u, v and the normal n, its origin is the first point of friction.
/// Relative motions are those of a against b there, and impulses act on b.
struct ContactPatch {
  std::size_t first;  // index of its first point
  int count, a, b;
  int separations;          // sweeps that could not solve it simultaneously
  bool grips;               // true if its spring acts alike in all directions
  bool twists;              // true for a hand's contact, which resists spin about n
  Matrix3 axes;             // rows u, v, n
  Vector3 arm_a, arm_b;     // of the origin, world axes [m]
  Motion6 drive;            // relative motion by that of a hand
  Motion6 by_twist;         // change of the relative motion by a unit impulse about n
  Eigen::Matrix4d inverse;  // normal impulses by missing speeds, if solved together [kg]

  Motion6 relative_motion(const PatchBody& a, const PatchBody& b) const;
  /// Changes the motions of the bodies by impulses on b.
  void apply(const Motion6& impulse, PatchBody& a, PatchBody& b) const;
  /// Sets the impulses of a point to those of a force in world axes [N]: f = t - p n, p cut off at 0. If it
  /// twists, to the torque of its spring too; those of a grip to its stretch alone.
  void start_from(const Vector3& force, const Spring& spring, double step, PatchPoint& point, PatchBody& a,
                  PatchBody& b) const;
  /// Solves the patch with all others fixed: changes the relative motion, and adds to the impulse that
  /// apply() then gives to the bodies. `points`: its first. `twisted`: the spring of its point if it twists.
  void relax(double step, PatchPoint* points, const Spring* twisted, Motion6& motion, Motion6& impulse);
  /// Writes the response that settle() reads. `row`: its spring is as the point was made from.
  void fill_response(double step, const PatchPoint& point, const Motion6& motion, SpringContact& row) const;

 private:
  bool relax_normals_together(PatchPoint* points, Motion6& motion, Motion6& impulse);
  void relax_twist(double step, const Spring& spring, PatchPoint& point, Motion6& motion,
                   Motion6& impulse) const;
};

/// Makes the patch of `count` rows, and adds its points.
ContactPatch make_patch(double step, const SpringContact* rows, int count,
                        const std::vector<PatchBody>& bodies, std::vector<PatchPoint>& points);

// Inline, as each sweep calls them for each patch.
[[gnu::always_inline]] inline Motion6 ContactPatch::relative_motion(const PatchBody& of_a,
                                                                    const PatchBody& of_b) const {
  const Motion6 &m = of_a.motion, &o = of_b.motion;
  Motion6 motion = drive;
  Vector3 linear = Vector3::Zero();
  if (of_a.inverse_mass != 0.0) linear = m.head<3>() + m.tail<3>().cross(arm_a);
  linear -= o.head<3>();
  linear -= o.tail<3>().cross(arm_b);
  motion.head<3>() += axes * linear;
  motion.tail<3>() += axes * (m.tail<3>() - o.tail<3>());
  return motion;
}

//     v_b += J / m_b,  w_b += I_b^-1 (b x J + L),      v_a and w_a by -J and -L
[[gnu::always_inline]] inline void ContactPatch::apply(const Motion6& impulse, PatchBody& of_a,
                                                       PatchBody& of_b) const {
  const Vector3 linear = axes.transpose() * impulse.head<3>();
  const Vector3 angular = axes.transpose() * impulse.tail<3>();
  of_b.motion.head<3>() += of_b.inverse_mass * linear;
  of_b.motion.tail<3>() += of_b.inverse_inertia * (arm_b.cross(linear) + angular);
  if (of_a.inverse_mass == 0.0) return;
  of_a.motion.head<3>() -= of_a.inverse_mass * linear;
  of_a.motion.tail<3>() -= of_a.inverse_inertia * (arm_a.cross(linear) + angular);
}

}  // namespace mrhi
