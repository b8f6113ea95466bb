#pragma once

#include "arguments.h"

namespace mrhi::real_grasps {

/// Plays all that the arguments ask for; prints it, and writes tables. Throws std::exception with one line.
void run(const Arguments& arguments);

}  // namespace mrhi::real_grasps
