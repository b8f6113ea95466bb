#pragma once

#include <string>
#include <vector>

namespace mrhi {

/// Runs a script of this package, no shell between, and waits for it. Returns its exit status. Throws
/// std::runtime_error naming the script if it is not found or cannot be started.
int run_script(const std::string& name, const std::vector<std::string>& arguments);

}  // namespace mrhi
