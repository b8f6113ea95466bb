#include "short_turns.h"

namespace mrhi {

#ifdef __AVX2__
static void turn_four(const Spinner<Lanes>& bodies, Turning<Lanes>& states) {
  turn_shortly(wide(bodies), wide(states));
}
const ShortTurns kAvx2Turns = turn_four;
#else
const ShortTurns kAvx2Turns = nullptr;
#endif

}  // namespace mrhi
