#include "island_contact.h"

namespace mrhi {
namespace {

/// The contact's own damping, as the time by which a spring with a dashpot beside it (Kelvin-Voigt) looks
/// ahead. A step solved at its end damps as much as half the step does, so only the rest is added: a held
/// object comes to rest equally fast at every step length [s].
constexpr double kRelaxation = 0.005;

/// Lever at which the tangential springs of a fingertip's contact patch resist twisting about the normal [m].
constexpr double kTwistLever = 0.025;

/// Friction torque of a patch that presses evenly, over friction times push times its radius.
constexpr double kPatchTorque = 2.0 / 3.0;

/// Nothing is damped before it touches.
double look_ahead(double step, double depth, bool damping) {
  return step + (damping && depth > 0.0 ? std::max(0.0, kRelaxation - 0.5 * step) : 0.0);
}

double friction_of(const Material& material, Friction friction) {
  return friction == Friction::sticking ? material.static_friction : material.dynamic_friction;
}

}  // namespace

void make_spring(const ContactStep& step, const Contact& contact, const ContactConfiguration& configuration,
                 IslandContact& result) {
  const Body& body = step.scene.bodies[contact.key.body];
  const Vector3& n = contact.normal;
  const Vector3 reach = contact.hand_point - contact.point + contact.lever;
  Spring<double>& spring = result.spring;
  spring.normal = triple(n);
  spring.stretch = triple(reach - n.dot(reach) * n);
  spring.depth = contact.depth;
  spring.twist = contact.twist;
  spring.ahead = look_ahead(step.step, contact.depth, configuration.damping);
  spring.stiffness = body.material.stiffness * contact.share;
  spring.twist_stiffness = configuration.torsion ? spring.stiffness * (kTwistLever * kTwistLever) : 0.0;
  spring.friction = friction_of(body.material, contact.friction);
  spring.patch_friction = kPatchTorque * spring.friction * contact.patch;
  spring.slip_limit = spring.twist_limit = 0.0;
  result.arm_b = contact.point - step.bodies[contact.key.body].pose.position;
  result.drive = contact.hand_velocity;
  result.drive_spin = contact.hand_spin;
  result.a = IslandContact::kAlone;
}

void make_spring(const ContactStep& step, const BodyContact& contact,
                 const ContactConfiguration& configuration, IslandContact& result) {
  Spring<double>& spring = result.spring;
  spring.normal = triple(contact.normal);
  spring.stretch = triple(contact.stretch);
  spring.depth = contact.depth;
  spring.twist = 0.0;
  spring.ahead = look_ahead(step.step, contact.depth, configuration.damping);
  spring.stiffness = configuration.object_stiffness * contact.share;
  spring.twist_stiffness = spring.patch_friction = 0.0;
  spring.friction = friction_of(contact.material, contact.friction);
  spring.slip_limit = spring.twist_limit = 0.0;
  result.arm_a = contact.arm_a;
  result.arm_b = contact.arm_b;
  result.drive.setZero();
  result.drive_spin = 0.0;
  result.a = IslandContact::kAlone;
}

void settle(const ContactStep& step, const IslandContact& solved, Contact& contact) {
  const Material& material = step.scene.bodies[contact.key.body].material;
  const Settled settled =
      settle(solved.spring, solved.response, contact.friction, material.dynamic_friction, step.step);
  contact.force = vector(solved.response.force);
  contact.friction = settled.friction;
  contact.twist = settled.twist;
  if (settled.slide.isZero(0.0)) return;
  contact.god_object =
      step.bodies[contact.key.body].pose.to_local(contact.point + settled.slide - contact.lever);
}

void settle(const ContactStep& step, const IslandContact& solved, BodyContact& contact) {
  const Settled settled =
      settle(solved.spring, solved.response, contact.friction, contact.material.dynamic_friction, step.step);
  contact.force = vector(solved.response.force);
  contact.friction = settled.friction;
  if (settled.slide.isZero(0.0)) return;
  const Pose& pose = step.bodies[contact.key.b].pose;
  contact.anchor_b = pose.to_local(pose * contact.anchor_b + settled.slide);
}

}  // namespace mrhi
