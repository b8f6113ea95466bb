#pragma once

#include "hand_chain.h"

namespace mrhi {

/// The offset on its way back to none, from where it was at the frame before to `stamp`: it decays, and no
/// joint goes farther in one frame than a person would see as a jump. Within the joints' limits of now.
/// `chain` has the palm so (lag_returning).
HandOffset returning(const HandOffset& offset, Nanoseconds stamp, HandChain& chain);

/// HandOffset::lag likewise.
PalmLag lag_returning(const HandOffset& offset, Nanoseconds stamp);

}  // namespace mrhi
