#pragma once

#include <stdexcept>

namespace mrhi {

/// A command line that cannot be followed. what() is one line: the option, what it says, what is allowed.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace mrhi
