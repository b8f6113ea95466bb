#pragma once

#include "mr_hand_interaction/configuration.h"
#include "mr_hand_interaction/tracking/filter_memory.h"

namespace mrhi {

/// The filtered hand for `sample`, taken `elapsed` seconds (above 0) after the one before. A memory that is
/// empty starts with `sample` as it is. All points of a hand are filtered alike: a joint that two bones share
/// stays one joint. docs/filters.md compares the filters.
Hand filtered(const Hand& sample, double elapsed, const FilterConfiguration& filter, FilterMemory& memory);

}  // namespace mrhi
