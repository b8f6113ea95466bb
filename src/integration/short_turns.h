#pragma once

#include "short_turn.h"

namespace mrhi {

/// Short turns of four bodies side by side, for one kind of processor. All kinds give the same bits, and
/// those of turn_shortly on one body.
using ShortTurns = void (*)(const Spinner<Lanes>& bodies, Turning<Lanes>& states);

extern const ShortTurns kPortableTurns;
extern const ShortTurns kAvx2Turns;  ///< null where not compiled in

/// The widest that this processor has.
ShortTurns short_turns();

}  // namespace mrhi
