#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mrhi {

/// Entries that have a `name` and a `place` each, in the order of their places and then of their names.
template <typename Entry>
std::vector<const Entry*> in_their_places(std::vector<const Entry*> entries) {
  const auto order = [](const Entry* entry) {
    return std::make_pair(entry->place, std::string_view(entry->name));
  };
  std::sort(entries.begin(), entries.end(),
            [&](const Entry* a, const Entry* b) { return order(a) < order(b); });
  return entries;
}

/// Throws std::invalid_argument for a name that none has; `kind` is what they are called there.
template <typename Entry>
const Entry& entry_named(const std::vector<const Entry*>& entries, std::string_view name, const char* kind) {
  for (const Entry* entry : entries)
    if (entry->name == name) return *entry;
  std::string names;
  for (const Entry* entry : entries) names += (names.empty() ? "" : ", ") + std::string(entry->name);
  throw std::invalid_argument(std::string(kind) + " '" + std::string(name) +
                              "' is not known; allowed: " + names);
}

}  // namespace mrhi
