#pragma once

#include "mr_hand_interaction/response/contact_model.h"

namespace mrhi {

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
  static constexpr double kStiffness = 500.0;
  /// The coupling's damper is critical for a virtual phalanx of this mass: b = 2 sqrt(k m), 4.5 N s/m at 500
  /// N/m [kg].
  static constexpr double kPhalanxMass = 0.01;

  void respond(ContactStep& step) override;
};

}  // namespace mrhi
