#pragma once

#include "mr_hand_interaction/response/contact_model.h"

namespace mrhi {

/// A reduced stand-in for the soft hand of the paper's reference [20] (CLAP), not that hand: no flesh is
/// deformed. About each point by which a phalanx touches, the skin carries a grid of pads on springs, five
/// along the phalanx and three across. Each pad's depth is that of the skin where it sits, along the normal
/// by which the phalanx entered; each has friction of its own. Pads remember nothing by themselves: how far
/// they are sheared and twisted is the contact's god object and turn about the normal, so that a pad that
/// slips by itself does so without creep, and the grip slides once its deepest pad does. Explicit.
class SoftPadModel : public ContactModel {
 public:
  static constexpr int kAlong = 5, kAcross = 3;
  /// Between pads, as a part of the phalanx's radius.
  static constexpr double kSpacing = 0.5;
  /// Of all pads of a phalanx together, unless material/stiffness is set [N/m].
  static constexpr double kStiffness = 500.0;
  /// A pad has a damper beside its spring: its damping over its stiffness [s].
  static constexpr double kRelaxation = 0.01;

  void respond(ContactStep& step) override;
};

}  // namespace mrhi
