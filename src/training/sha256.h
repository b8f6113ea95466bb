#pragma once

#include <string>

namespace mrhi {

/// SHA-256 of bytes (FIPS 180-4), as 64 lower-case hexadecimal digits; what `sha256sum` prints.
std::string sha256(const std::string& bytes);

}  // namespace mrhi
