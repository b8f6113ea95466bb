#include "island_contact.h"

#include <algorithm>

namespace mrhi {
namespace {

/// The contact's own damping, as the time by which a spring with a dashpot beside it (Kelvin-Voigt) looks
/// ahead. A step solved at its end damps as much as half the step does, so only the rest is added: a held
/// object comes to rest equally fast at every step length [s].
constexpr double kRelaxation = 0.005;

/// Lever at which the tangential springs of a fingertip's contact patch resist twisting about the normal [m].
constexpr double kTwistLever = 0.025;

/// Nothing is damped before it touches.
double look_ahead(double step, double depth) {
  return step + (depth > 0.0 ? std::max(0.0, kRelaxation - 0.5 * step) : 0.0);
}

void set_friction(const Material& material, Friction friction, SpringContact& spring) {
  spring.before = friction;
  spring.friction = friction == Friction::sticking ? material.static_friction : material.dynamic_friction;
  spring.dynamic_friction = material.dynamic_friction;
}

}  // namespace

IslandContact hand_spring(const ContactStep& step, const Contact& contact, bool torsion) {
  const Body& body = step.scene.bodies[contact.key.body];
  IslandContact result;
  result.arm_b = contact.point - step.bodies[contact.key.body].pose.position;
  result.drive = contact.hand_velocity;
  result.drive_spin = contact.hand_spin;
  SpringContact& spring = result.spring;
  spring.normal = contact.normal;
  const Vector3 reach = contact.hand_point - contact.point + contact.lever;
  spring.stretch = reach - contact.normal.dot(reach) * contact.normal;
  spring.depth = contact.depth;
  spring.twist = contact.twist;
  spring.patch = contact.patch;
  spring.step = step.step;
  spring.ahead = look_ahead(step.step, contact.depth);
  spring.stiffness = body.material.stiffness * contact.share;
  spring.twist_stiffness = torsion ? spring.stiffness * kTwistLever * kTwistLever : 0.0;
  set_friction(body.material, contact.friction, spring);
  return result;
}

IslandContact body_spring(const ContactStep& step, const BodyContact& contact, double stiffness) {
  IslandContact result;
  result.arm_a = contact.arm_a;
  result.arm_b = contact.arm_b;
  SpringContact& spring = result.spring;
  spring.normal = contact.normal;
  spring.stretch = contact.stretch;
  spring.depth = contact.depth;
  spring.twist = spring.patch = 0.0;
  spring.step = step.step;
  spring.ahead = look_ahead(step.step, contact.depth);
  spring.stiffness = stiffness * contact.share;
  spring.twist_stiffness = 0.0;
  set_friction(contact.material, contact.friction, spring);
  return result;
}

void settle(const ContactStep& step, const IslandContact& solved, const Vector3& u, double spin,
            Contact& contact) {
  const SpringContact::Settled settled = solved.spring.settle(u, spin);
  contact.force = settled.force;
  contact.friction = settled.friction;
  contact.twist = settled.twist;
  if (!settled.slide.isZero(0.0)) {
    const Pose& pose = step.bodies[contact.key.body].pose;
    contact.god_object = pose.to_local(contact.point + settled.slide - contact.lever);
  }
}

void settle(const ContactStep& step, const IslandContact& solved, const Vector3& u, double spin,
            BodyContact& contact) {
  const SpringContact::Settled settled = solved.spring.settle(u, spin);
  contact.force = settled.force;
  contact.friction = settled.friction;
  if (!settled.slide.isZero(0.0)) {
    const Pose& pose = step.bodies[contact.key.b].pose;
    contact.anchor_b = pose.to_local(pose * contact.anchor_b + settled.slide);
  }
}

}  // namespace mrhi
