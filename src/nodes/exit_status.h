#pragma once

#include <exception>
#include <functional>
#include <iostream>
#include <string>

#include "mr_hand_interaction/input_error.h"

namespace mrhi {

/// Runs a program. Returns 0; or, with one line on stderr, 2 for a UsageError and 1 for another
/// std::exception.
inline int exit_status(const std::string& program, const std::function<int()>& work) {
  try {
    return work();
  } catch (const UsageError& error) {
    std::cerr << program << ": " << error.what() << std::endl;
    return 2;
  } catch (const std::exception& error) {
    std::cerr << program << ": " << error.what() << std::endl;
    return 1;
  }
}

}  // namespace mrhi
