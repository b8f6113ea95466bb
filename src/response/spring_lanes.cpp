#include "spring_lanes_work.h"

namespace mrhi {

const SpringLanes kPortableLanes{respond, slope};

const SpringLanes& spring_lanes() {
#if defined(__x86_64__)
  if (kAvx2Lanes != nullptr && __builtin_cpu_supports("avx2")) return *kAvx2Lanes;
#endif
  return kPortableLanes;
}

}  // namespace mrhi
