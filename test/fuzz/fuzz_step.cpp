// The step itself: whatever hands do, what the laws say holds.
#include "fuzz/played_step.h"

FUZZ_TARGET(step) {
  using namespace mrhi::fuzzing;
  const StepCase made = step_case(data, size);
  require(play(made).hash == play(made).hash, "equal input gives equal bits");
}
