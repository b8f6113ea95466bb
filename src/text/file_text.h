#pragma once

#include <optional>
#include <string>

namespace mrhi {

/// The first `most` bytes of a regular file, or nothing if it cannot be read.
std::optional<std::string> file_text(const std::string& file, std::size_t most);

}  // namespace mrhi
