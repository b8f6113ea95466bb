#include "spring_lanes_work.h"

namespace mrhi {

#ifdef __AVX2__
static const SpringLanes kLanesHere{respond, slope};
const SpringLanes* const kAvx2Lanes = &kLanesHere;
#else
const SpringLanes* const kAvx2Lanes = nullptr;
#endif

}  // namespace mrhi
