#pragma once

#include <stdexcept>
#include <string>

namespace mrhi {

/// Error of an unusable file or request. what() is one line, whatever characters the file's name has: the
/// file, the item in it, and what is allowed.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message);
};

/// Error of an invalid command line. what() is one line: the option, its value, what is allowed.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace mrhi
