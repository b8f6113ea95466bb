#include "hand_filter.h"

#include "../text/registry.h"
#include "hand_filter_list.h"

namespace mrhi {

#define MRHI_DECLARE(name) extern const HandFilter name;
#define MRHI_ADDRESS(name) &(name),
MRHI_ENTRIES(MRHI_DECLARE)

namespace {

std::vector<FilterSetting> settings_of_all() {
  std::vector<FilterSetting> all;
  for (const HandFilter* filter : hand_filters())
    for (const FilterSetting& setting : filter->settings()) all.push_back(setting);
  return all;
}

}  // namespace

const std::vector<const HandFilter*>& hand_filters() {
  static const std::vector<const HandFilter*> filters =
      in_their_places<HandFilter>({MRHI_ENTRIES(MRHI_ADDRESS)});
  return filters;
}

const HandFilter& hand_filter(FilterKind kind) {
  return entry_named(hand_filters(), kind.name, "filter");
}

const std::vector<FilterSetting>& filter_settings() {
  static const std::vector<FilterSetting> settings = settings_of_all();
  return settings;
}

FilterConfiguration filter_of(const Configuration& configuration) {
  FilterConfiguration filter = configuration.filter;
  if (is_literal(configuration)) {
    filter.type = FilterKind::window;
    filter.as_printed = true;
  }
  return filter;
}

Hand filtered(const Hand& sample, double elapsed, const FilterConfiguration& filter, FilterMemory& memory) {
  if (memory.empty()) {
    memory.restart(sample);
    return sample;
  }
  const HandFilter& chosen = hand_filter(filter.type);
  memory.history.push(sample, elapsed, chosen.samples_needed(filter));
  memory.filtered = chosen.pass(elapsed, filter, memory);
  return memory.filtered;
}

}  // namespace mrhi
