#pragma once

#include <optional>

namespace mrhi {

/// What a node's arguments alone decide, before there is a master: --help prints the usage, 0; an argument
/// that is not roslaunch's is told in one line, 2. Nothing: the node is to run.
std::optional<int> status_of_arguments(int argc, char** argv, const char* usage);

}  // namespace mrhi
