#pragma once

#include <string>

namespace mrhi {

/// Whether a text may name a thing or a person: 1 to 64 letters, digits, '_' and '-', not first '-'. So a
/// name is neither a path nor an option, nor what a spreadsheet takes for a formula or a terminal for a
/// command.
bool is_name(const std::string& text);

/// What is_name() takes, for messages.
extern const char* const kNameIs;

}  // namespace mrhi
