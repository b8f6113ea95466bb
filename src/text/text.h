#pragma once

#include <algorithm>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mr_hand_interaction/math.h"

/// How values appear in error messages: short, on one line, the same in every locale.
namespace mrhi::text {

std::string number(double value);
/// The shortest that is read back as the same bits.
std::string exact(double value);
std::string vector(const Vector3& value);
/// The number that is the whole text, with a decimal point whatever the locale; nothing of anything else.
std::optional<double> to_number(const std::string& text);
std::string joined(const std::vector<std::string>& names);

/// The names of items that have one each.
template <typename Items>
std::vector<std::string> names_of(const Items& items) {
  std::vector<std::string> names;
  std::transform(std::begin(items), std::end(items), std::back_inserter(names),
                 [](const auto& item) { return std::string(item.name); });
  return names;
}

/// What is between the commas: one more than there are.
std::vector<std::string> split(const std::string& text);

/// Line breaks become spaces, other control characters '?'; what is longer than `longest` characters is cut.
std::string one_line(const std::string& text, std::size_t longest = 300);

/// A name as people write it: without underscores.
std::string with_spaces(std::string name);

}  // namespace mrhi::text

namespace mrhi {

/// Whether a text may name a thing or a person: 1 to 64 letters, digits, '_' and '-', not first '-'. So a
/// name is neither a path nor an option, nor what a spreadsheet takes for a formula or a terminal for a
/// command.
bool is_name(const std::string& text);

/// What is_name() takes, for messages.
extern const char* const kNameIs;

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
