#include "short_turns.h"

namespace mrhi {

static void turn_four(const Spinner<Lanes>& bodies, Turning<Lanes>& states) {
  turn_shortly(wide(bodies), wide(states));
}
const ShortTurns kPortableTurns = turn_four;

ShortTurns short_turns() {
#if defined(__x86_64__)
  if (kAvx2Turns != nullptr && __builtin_cpu_supports("avx2")) return kAvx2Turns;
#endif
  return kPortableTurns;
}

}  // namespace mrhi
