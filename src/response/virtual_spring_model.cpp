#include <algorithm>
#include <cmath>

#include "contact_step.h"
#include "impact.h"
#include "penetration_force.h"

namespace mrhi {
namespace {

/// A virtual phalanx hangs on the tracked one by a spring and a damper (Borst & Indugula, "A spring model for
/// whole-hand virtual grasping", Presence 15(1), 2006; the paper's reference [23], Delrieu et al. 2020).
/// Those systems give the virtual phalanx a small mass and let an engine keep it outside the object. Here it
/// is reduced to the point where it rests on the surface (the god object), without mass: what the coupling
/// pulls it with is what it presses and drags the object with, up to Coulomb's limit, beyond which it is
/// dragged over the surface. Explicit, as those systems are: forces of a step are those at its start.
class VirtualSpringModel : public ContactModel {
 public:
  /// Of the coupling, unless material/stiffness is set. An explicit spring and damper ask for steps below
  /// 2 / sqrt(sum k / m) and 2 m / sum b [N/m].
  /// Of N phalanges both together ask for h^2 N k + 2 h N b < 4 m, where each alone has the bounds above: p
  /// += -h (k x + b p / m), x += h p / m has its roots within the unit circle up to there
  /// (docs/speed_accuracy.md: of 2433 cells beyond it 12 are stable).
  static constexpr double kStiffness = 500.0;
  /// The coupling's damper is critical for a virtual phalanx of this mass: b = 2 sqrt(k m), 4.5 N s/m at 500
  /// N/m [kg].
  static constexpr double kPhalanxMass = 0.01;

  void respond(ContactStep& step) override;
};

/// Force of the coupling on the object [N]; drags the virtual phalanx where it slips.
///
///     N = max(0, k d - b v_n),     f_T = coulomb(k s + b v_t),     f = f_T - N n          on the object
///
/// v is the hand's against the object's (Eq. 8), so that b v_n < 0 as they approach pushes the more. The
/// damper makes the push begin with a jump, b |v_n|, at the touch: what Hunt & Crossley (1975) object to in
/// it, and what those systems have.
Vector3 coupling_force(const Body& body, const BodyState& state, Contact& contact) {
  const double stiffness = body.material.stiffness * contact.share;
  if (!contact.touching() || stiffness <= 0.0) return Vector3::Zero();
  const double damping =
      2.0 * std::sqrt(body.material.stiffness * VirtualSpringModel::kPhalanxMass) * contact.share;
  const Vector3& n = contact.normal;
  const Vector3 velocity = relative_velocity(contact, body, state);
  const double normal_velocity = n.dot(velocity);
  // The virtual phalanx rests on the surface: the coupling presses it on, but the surface cannot hold it
  // back.
  const double push = std::max(0.0, stiffness * contact.depth - damping * normal_velocity);

  const Vector3 reach = contact.hand_point - contact.point;
  const Vector3 stretch = reach - n.dot(reach) * n;
  const Vector3 along = velocity - normal_velocity * n;
  const Tangential tangential =
      coulomb(stiffness * stretch + damping * along, push, body.material, contact.friction);
  contact.friction = tangential.friction;
  if (tangential.friction == Friction::slipping) {
    contact.point += stretch - tangential.force / stiffness;
    contact.god_object = state.pose.to_local(contact.point);
  }
  return tangential.force - push * n;
}

}  // namespace

void VirtualSpringModel::respond(ContactStep& step) {
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

extern const ContactModelEntry virtual_spring_model{
    "virtual_spring", 4, VirtualSpringModel::kStiffness,
    [](const ContactConfiguration&) -> std::unique_ptr<ContactModel> {
      return std::make_unique<VirtualSpringModel>();
    }};

}  // namespace mrhi
