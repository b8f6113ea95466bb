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

/// Formats values for error messages: short, on one line, the same in every locale.
namespace mrhi::text {

std::string number(double value);
/// Shortest text that is read back as the same bits.
std::string exact(double value);
std::string exact(const Vector3& value);  ///< "[x, y, z]"
std::string vector(const Vector3& value);
std::string quaternion(const Quaternion& value);  ///< "[x, y, z, w]"
/// A text in the format of printf.
std::string format(const char* form, ...) __attribute__((format(printf, 1, 2)));
/// Converts a whole text to a number, with a decimal point in any locale; empty for any other text.
std::optional<double> to_number(const std::string& text);
/// The texts of any sequence with a separator between each two.
template <typename Texts = std::vector<std::string>>
std::string joined(const Texts& texts, const std::string& separator = ", ") {
  std::string list;
  for (const auto& text : texts) list += (list.empty() ? "" : separator) + text;
  return list;
}
/// The texts with commas, for a message; "none" if there are none.
template <typename Texts>
std::string joined_or_none(const Texts& texts) {
  return texts.empty() ? "none" : joined(texts);
}

template <typename Items>
std::vector<std::string> names_of(const Items& items) {
  std::vector<std::string> names;
  std::transform(std::begin(items), std::end(items), std::back_inserter(names),
                 [](const auto& item) { return std::string(item.name); });
  return names;
}

/// The item of that name; null if there is none.
template <typename Items>
auto* find_named(Items& items, std::string_view name) {
  const auto found =
      std::find_if(std::begin(items), std::end(items), [&](const auto& item) { return item.name == name; });
  return found == std::end(items) ? nullptr : &*found;
}

/// The words of a text, which blanks and line breaks separate.
std::vector<std::string> words(const std::string& text);

/// Splits at commas.
std::vector<std::string> split(const std::string& text);

/// Replaces line breaks by spaces, and other control characters and bytes that are no UTF-8 by '?';
/// truncates to `max_bytes` bytes.
std::string one_line(const std::string& text, std::size_t max_bytes = 300);

/// The same in quotes, for a name in a message.
std::string quoted(const std::string& name, std::size_t max_bytes = 60);

std::string in_lower_case(std::string text);  ///< of ASCII letters

/// A name for display: without underscores.
std::string with_spaces(std::string name);

}  // namespace mrhi::text

namespace mrhi {

/// True if a text is a valid name of a thing or a person: 1 to 64 letters, digits, '_' and '-', not first
/// '-'. So a name is neither a path, an option, a spreadsheet's formula nor a terminal's command.
bool is_name(const std::string& text);

/// Rule of is_name(), for messages.
extern const char* const kNameIs;

/// Returns what `work` does. Its exceptions of type From become To, their texts with `before` in front.
template <typename To, typename From, typename Work>
decltype(auto) rethrown(const std::string& before, const Work& work) {
  try {
    return work();
  } catch (const From& error) {
    throw To(before + error.what());
  }
}

/// Sorts entries with a `name` and a `place` each by their places, then names.
template <typename Entry>
std::vector<const Entry*> in_their_places(std::vector<const Entry*> entries) {
  const auto order = [](const Entry* entry) {
    return std::make_pair(entry->place, std::string_view(entry->name));
  };
  std::sort(entries.begin(), entries.end(),
            [&](const Entry* a, const Entry* b) { return order(a) < order(b); });
  return entries;
}

/// Throws std::invalid_argument for an unknown name; `kind` is the entries' kind in the message.
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
