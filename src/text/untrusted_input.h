#pragma once

#include <functional>
#include <optional>
#include <string>

namespace mrhi {

constexpr std::size_t kMaxXmlBytes = 4 * 1024 * 1024;

bool is_utf8(const std::string& text);
/// Length in bytes of the UTF-8 character at a place of a text; 0: none.
std::size_t utf8_length(const std::string& text, std::size_t at);

/// Returns a construct that would overload an XML library, with what is allowed; empty if there is none.
/// Libraries recurse as deep as elements are nested, and need quadratic time in an element's attributes.
std::optional<std::string> xml_danger(const std::string& xml);

/// Resource limits of a child process.
struct ChildLimits {
  double seconds;              ///< of real time
  std::size_t memory, output;  ///< beyond this process's memory; of the result [bytes]
};

/// Runs `work` in a child process and returns its result. Throws std::runtime_error with the text of its
/// exception, or with the exceeded limit or the cause of its end. This process is not affected.
/// `is_cancelled` is called ten times a second; once it returns true, the child is ended.
std::string run_in_child(const ChildLimits& limits, const std::function<std::string()>& work,
                         const std::function<bool()>& is_cancelled = {});

}  // namespace mrhi
