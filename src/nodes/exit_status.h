#pragma once

#include <exception>
#include <functional>
#include <iostream>
#include <string>

#include "../text/text.h"
#include "mr_hand_interaction/input_error.h"

namespace mrhi {

/// Prints an error on one line of stderr, without characters that a terminal takes for commands.
inline void print_error(const std::string& program, const std::exception& error) {
  std::cerr << program << ": " << text::one_line(error.what(), 4000) << std::endl;
}

/// Runs a program. Returns 0; or after one line on stderr, 2 for a UsageError, 1 for another exception.
inline int exit_status(const std::string& program, const std::function<int()>& work) {
  try {
    return work();
  } catch (const UsageError& error) {
    print_error(program, error);
    return 2;
  } catch (const std::exception& error) {
    print_error(program, error);
    return 1;
  }
}

}  // namespace mrhi
