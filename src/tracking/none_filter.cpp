#include "hand_filter.h"

namespace mrhi {

/// Returns the newest sample.
extern const HandFilter none_filter{
    "none", 0, []() -> std::vector<FilterSetting> { return {}; },
    [](const FilterConfiguration&) { return 1; },
    [](double, const FilterConfiguration&, FilterMemory& memory) { return memory.history.samples[0]; }};

}  // namespace mrhi
