#pragma once

#include <optional>
#include <string>

namespace mrhi {

constexpr std::size_t kMostXmlBytes = 4 * 1024 * 1024;

bool is_utf8(const std::string& text);

/// What would lead an XML library astray, with what is allowed; nothing: none of it. Libraries recurse as
/// deep as elements are nested, and take a time that grows with the square of an element's attributes.
std::optional<std::string> xml_danger(const std::string& xml);

}  // namespace mrhi
