#pragma once

#include <functional>
#include <optional>
#include <string>

namespace mrhi {

constexpr std::size_t kMostXmlBytes = 4 * 1024 * 1024;

bool is_utf8(const std::string& text);

/// What would lead an XML library astray, with what is allowed; nothing: none of it. Libraries recurse as
/// deep as elements are nested, and take a time that grows with the square of an element's attributes.
std::optional<std::string> xml_danger(const std::string& xml);

/// What a child process may use.
struct ChildLimits {
  int seconds;                 ///< of the processor, and four times as many by the clock
  std::size_t memory, output;  ///< beyond what this process has; of what it gives [bytes]
};

/// Runs `work` in a child process and gives what it returns; an exception's text is thrown as
/// std::runtime_error. What takes more than the limits, or ends the process, throws std::runtime_error that
/// says which, and leaves this process as it was.
std::string run_in_child(const ChildLimits& limits, const std::function<std::string()>& work);

}  // namespace mrhi
