#pragma once

#include <optional>
#include <string>

namespace mrhi {

constexpr std::size_t kMostXmlBytes = 4 * 1024 * 1024;

/// What would lead the XML library astray, with what is allowed; nothing: none of it. TinyXML reads past its
/// buffer on text that is not UTF-8, and recurses as deep as elements are nested, at a cost that grows with
/// the square.
std::optional<std::string> xml_danger(const std::string& xml);

}  // namespace mrhi
