#include <algorithm>
#include <cmath>

#include "contact_step.h"
#include "impact.h"
#include "penetration_model.h"

namespace mrhi {
namespace {

/// Mass of a virtual phalanx for which the damper is critical: b = 2 sqrt(k m), 4.5 N s/m at 500 N/m [kg].
constexpr double kPhalanxMass = 0.01;

/// Force of the coupling on the object [N]; moves the virtual phalanx where it slips.
///
///     N = max(0, k d - b v_n),     f_T = coulomb(k s + b v_t),     f = f_T - N n          on the object
///
/// v is the hand's velocity relative to the object (Eq. 8), so approach, b v_n < 0, increases N. The damper
/// makes N start with a jump, b |v_n|, at first touch. Hunt & Crossley (1975) object to this jump, but those
/// systems have it.
Vector3 coupling_force(const Body& body, const BodyState& state, Contact& contact) {
  const double stiffness = body.material.stiffness * contact.share;
  if (!contact.touching() || stiffness <= 0.0) return Vector3::Zero();
  const double damping = 2.0 * std::sqrt(body.material.stiffness * kPhalanxMass) * contact.share;
  const Vector3& n = contact.normal;
  const Vector3 velocity = relative_velocity(contact, body, state);
  const double normal_velocity = n.dot(velocity);
  // The virtual phalanx rests on the surface: the coupling may push it on, but the surface cannot pull it
  // back.
  const double load = std::max(0.0, stiffness * contact.depth - damping * normal_velocity);
  const Vector3 along = velocity - normal_velocity * n;
  return tangential_force(body.material, stiffness, damping * along, load, state, contact) - load * n;
}

/// A virtual phalanx coupled to the tracked one by a spring and a damper (Borst & Indugula, "A spring model
/// for whole-hand virtual grasping", Presence 15(1), 2006; the paper's reference [23], Delrieu et al. 2020).
/// Those systems give the virtual phalanx a small mass and let an engine keep it outside the object. Here it
/// is reduced to its point on the surface (the god object), without mass. The coupling's force acts on the
/// object up to Coulomb's limit, beyond which the point slides. Explicit, as those systems are: forces are
/// those at the start of the step.
class VirtualSpringModel : public ContactModel {
 public:
  void respond(ContactStep& step) override {
    for (Contact& contact : step.contacts) {
      const std::size_t body = contact.key.body;
      contact.force = coupling_force(step.scene.bodies[body], step.bodies[body], contact);
    }
    for (const Contact& contact : step.contacts) {
      const std::size_t body = contact.key.body;
      if (!step.scene.bodies[body].fixed)
        apply_impulse(step.step * contact.force, contact.point, step.bodies[body]);
    }
  }
};

}  // namespace

/// An explicit spring and damper need steps below 2 / sqrt(sum k / m) and 2 m / sum b.
///
/// These are the bounds of each alone. For N phalanges both together need h^2 N k + 2 h N b < 4 m: up to
/// there p += -h (k x + b p / m), x += h p / m has its roots within the unit circle
/// (docs/speed_accuracy.md: of 2433 cells beyond it 12 are stable).
extern const ContactModelEntry virtual_spring_model{"virtual_spring", 4, 500.0,
                                                    make_model<VirtualSpringModel>};

}  // namespace mrhi
