#include "penetration_model.h"

#include <algorithm>
#include <cmath>

#include "impact.h"

namespace mrhi {

// Eqs. 16 and 17: gamma times the depth, along n alone. The fade factor is not in the paper: without
// dissipation a held object in microgravity oscillates for ever.
//
//     N = gamma d max(0, 1 - v / v_r),     v = n.(c1' - c2') > 0 as they part,  v_r = kReleaseSpeed
//
// This is Hunt & Crossley's (1975) f = k d + lambda d d' with lambda = k / v_r, for separation only: on
// approach, Newton's impact law dissipates. A dashpot in parallel would jump at first touch, and pull during
// separation.
double normal_force(double stiffness, double depth, double normal_velocity, double fade) {
  if (depth <= 0.0) return 0.0;
  const double parting = std::max(normal_velocity, 0.0) * fade;
  return stiffness * depth * std::max(1.0 - parting, 0.0);
}

// Eqs. 18 to 20. As printed a sliding contact has phi f_t, which grows with the stretch without bound. Here
// it has phi |f_n| in the direction of f_t, Coulomb's law.
//
//     sticks:   f_T = f_t                     |f_t| <= mu N; having slipped, |f_t| <= 0.9 phi N
//     slips:    f_T = min(|f_t|, phi N) f_t / |f_t|
//
// The limit for sticking again is lower. With one limit for both, a contact at the rim would change state in
// every step.
Tangential coulomb(const Vector3& spring_force, double normal_force, const Material& material,
                   Friction before) {
  const double elastic = spring_force.norm();
  const double sliding = material.dynamic_friction * normal_force;
  const bool slips = before == Friction::sticking ? elastic > material.static_friction * normal_force
                                                  : elastic > kRestickRatio * sliding;
  if (!slips) return {spring_force, Friction::sticking};
  return {elastic > sliding ? Vector3(spring_force * (sliding / elastic)) : spring_force, Friction::slipping};
}

// Eq. 16, f = gamma (p - c), and its parts: along n gamma times the depth (Eq. 17), tangentially gamma times
// the stretch (Eq. 18). n points out of the object, so the normal force on it is -N n, and friction is along
// the stretch.
//
//     f = -N n + f_T(gamma s + c w_t),      s = P (p - c),  w_t = P (c1' - c2'),  P = 1 - n n'
//     c <- c + s - f_T / gamma               where it slips: then gamma s is f_T
//
// The paper's f is the force on the finger, gamma (c - p); the object has the opposite.
Vector3 tangential_force(const Material& material, double stiffness, const Vector3& drag, double load,
                         const BodyState& state, Contact& contact) {
  const Vector3 stretch = stretch_of(contact);
  // The dashpot acts within the cone too: friction limits the sum of spring and dashpot.
  const Tangential limited = coulomb(stiffness * stretch + drag, load, material, contact.friction);
  contact.friction = limited.friction;
  if (limited.friction == Friction::slipping) {
    contact.point += stretch - limited.force / stiffness;
    contact.god_object = state.pose.to_local(contact.point);
  }
  return limited.force;
}

Vector3 penetration_force(const Body& body, const BodyState& state, double damping, double fade,
                          Contact& contact) {
  contact.force.setZero();
  const double stiffness = body.material.stiffness * contact.share;
  if (!contact.touching() || stiffness <= 0.0) return contact.force;
  const Vector3& n = contact.normal;
  const Vector3 velocity = relative_velocity(contact, body, state);
  const double normal = normal_force(stiffness, contact.depth, n.dot(velocity), fade);
  const Vector3 drag = damping * contact.share * (velocity - n.dot(velocity) * n);
  contact.force = tangential_force(body.material, stiffness, drag, normal, state, contact) - normal * n;
  return contact.force;
}

// Explicit: momenta change by h f, one contact after the other. Undamped it needs steps below 2 sqrt(m / sum
// gamma); docs/speed_accuracy.md shows where it fails.
//
//     p += h f,  then  x += h p / m:  symplectic Euler's method, stable below h = 2 / w, w^2 = sum gamma / m
//
// Forces use the positions at the start of the step, and the velocities after the contacts before.
void penetration_phase(ContactStep& step) {
  const double fade = release_fade(step.configuration.release_fade);
  auto first = step.contacts.begin();
  while (first != step.contacts.end()) {
    const std::size_t index = first->key.body;
    const auto last = std::find_if(first, step.contacts.end(),
                                   [index](const Contact& contact) { return contact.key.body != index; });
    const Body& body = step.scene.bodies[index];
    BodyState& state = step.bodies[index];
    double share = 0.0;  // number of touching phalanges
    for (auto contact = first; contact != last; ++contact)
      share += contact->touching() ? contact->share : 0.0;
    // N touching phalanges have c = 2 zeta sqrt(N gamma m) together, so each has c / N, times its share.
    const double damping =
        body.fixed || share == 0.0 || !step.configuration.damping
            ? 0.0
            : kTangentialDamping * 2.0 * std::sqrt(body.material.stiffness * body.mass / share);
    for (auto contact = first; contact != last; ++contact) {
      const Vector3 force = penetration_force(body, state, damping, fade, *contact);
      if (!body.fixed) apply_impulse(step.step * force, contact->point, state);
    }
    first = last;
  }
}

namespace {

/// Penetration forces only, after the paper's reference [10] (Hoell et al. 2018).
class PenetrationModel : public ContactModel {
 public:
  void respond(ContactStep& step) override { penetration_phase(step); }
};

}  // namespace

/// The default stiffness is the paper's.
extern const ContactModelEntry penetration_model{"penetration", 2, 100.0, make_model<PenetrationModel>};

}  // namespace mrhi
