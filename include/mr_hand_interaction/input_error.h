#pragma once

#include <stdexcept>
#include <string>

namespace mrhi {

/// A file or a request that cannot be used. what() is one line, whatever the file's name holds: the file, the
/// thing in it, and what is allowed.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message);
};

/// A command line that cannot be followed. what() is one line: the option, what it says, what is allowed.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace mrhi
