#pragma once

#include <string>
#include <utility>
#include <vector>

namespace mrhi::json {

/// Twelve digits; what is no number is null.
std::string number(double value);
std::string quoted(const std::string& text);
/// [a, b]; items are JSON.
std::string list(const std::vector<std::string>& items);
/// {"name": value}; values are JSON.
std::string object(const std::vector<std::pair<std::string, std::string>>& members);

}  // namespace mrhi::json
