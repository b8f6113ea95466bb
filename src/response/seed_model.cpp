#include "contact_step.h"
#include "impact_solver.h"
#include "penetration_model.h"

namespace mrhi {
namespace {

/// The paper's two phases: an impulse when a phalanx collides (3.4.1), then penetration forces with Coulomb
/// friction during contact (3.4.2), as docs/contact.md reads the equations.
class SeedModel : public ContactModel {
 public:
  // The paper's order, 3.4.1 and then 3.4.2, matters: the springs' forces fade by the velocities after the
  // impact. The impact has no friction, since J = j n (Eq. 9).
  void respond(ContactStep& step) override {
    islands_.build(step);
    impacts_.resolve(step, islands_, ImpactFriction::none);
    // The approach of a penetrating phalanx has ended, with or without an impact.
    for (Contact& contact : step.contacts) contact.struck = contact.struck || contact.depth > 0.0;
    penetration_phase(step);
  }

 private:
  Islands islands_;
  ImpactSolver impacts_;
};

/// The same with the equations as printed (seed/literal). Two things differ from the print, without which
/// nothing could be held or moved. The object gets the opposite of Eqs. 9 and 16, and the penetration phase
/// needs penetration, f.n > 0.
class LiteralSeedModel : public ContactModel {
 public:
  void respond(ContactStep& step) override;

 private:
  void resolve_impact(ContactStep& step, Contact& contact);

  std::vector<BodyImpact> impact_;
};

/// Eqs. 8 to 15, point by point: J = j n, j = -(1 + e) u / n'Kn with K = 1/m "determined by the mass", and dv
/// = J / m without a spin. Once per approach, at the first touch.
void LiteralSeedModel::resolve_impact(ContactStep& step, Contact& contact) {
  contact.impulse.setZero();
  if (contact.ignored || contact.struck) return;
  const Body& body = step.scene.bodies[contact.key.body];
  BodyState& state = step.bodies[contact.key.body];
  const double approach = contact.normal.dot(relative_velocity(contact, body, state));
  const double time = time_to_close(-contact.depth, approach, 0.0);
  if (!(approach < 0.0) || time > step.step || body.fixed) return;
  const double impulse = -(1.0 + body.material.restitution) * approach * body.mass;
  contact.impulse = -impulse * contact.normal;
  contact.time_of_impact = time;
  contact.struck = true;
  state.linear_momentum += contact.impulse;
  impact_.assign(1, {contact.key.body, contact.impulse, Vector3::Zero(), time});
  step.changes.note_impacts(impact_, step.bodies);
}

/// Eqs. 16 to 20 for the centroid of the phalanx, p. The god object c is the surface point under it at first
/// touch: the contact's, which follows the axis parameter s of the contact, moved to the middle.
///
///     f = gamma (c - p),    d = n.(c - p),    s_t = (p - c) - n n.(p - c)
///     on the object:  -gamma d n + gamma s_t           |s_t| <= mu d      (Eq. 19)
///                     -gamma d n + phi gamma s_t       otherwise          (Eq. 20)
Vector3 literal_force(const Material& material, Contact& contact) {
  contact.force.setZero();
  const Vector3& n = contact.normal;
  const Vector3 to_middle = (0.5 - contact.axis_parameter) * contact.axis;
  const double depth = contact.depth - contact.radius - n.dot(to_middle);
  if (contact.ignored || depth <= 0.0) return contact.force;
  const Vector3 stretch = stretch_of(contact);
  const bool inside = stretch.norm() <= material.static_friction * depth;
  contact.friction = inside ? Friction::sticking : Friction::slipping;
  const double kept = inside ? 1.0 : material.dynamic_friction;
  contact.force = material.stiffness * (kept * stretch - depth * n);
  return contact.force;
}

void LiteralSeedModel::respond(ContactStep& step) {
  for (Contact& contact : step.contacts) resolve_impact(step, contact);
  for (Contact& contact : step.contacts) {
    contact.struck = contact.struck || contact.depth > 0.0;
    const Body& body = step.scene.bodies[contact.key.body];
    const Vector3 force = literal_force(body.material, contact);
    if (body.fixed) continue;
    const Vector3 to_middle = (0.5 - contact.axis_parameter) * contact.axis;
    const Vector3 under_it = contact.point + to_middle - contact.normal.dot(to_middle) * contact.normal;
    apply_impulse(step.step * force, under_it, step.bodies[contact.key.body]);
  }
}

}  // namespace

/// The default stiffness is the paper's.
extern const ContactModelEntry seed_model{
    "seed", 1, 100.0, [](const ContactConfiguration& configuration) -> std::unique_ptr<ContactModel> {
      if (configuration.literal) return std::make_unique<LiteralSeedModel>();
      return std::make_unique<SeedModel>();
    }};

}  // namespace mrhi
