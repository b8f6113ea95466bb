#pragma once

#include <string>

namespace mrhi {

/// Walks over the records of a bag (format 2.0) before the bag library does, which takes every length in it
/// on trust: lengths and places must be inside the file, those of messages inside their chunk. What is inside
/// a compressed chunk is not looked at. Throws BagError that names the place; a bag without an index is left
/// to the library, which says so.
void check_bag(const std::string& file);

/// The same of a file that may not be there, or not to be read.
void check_readable(const std::string& file);

/// Within a handler: what the bag library has thrown, as a BagError in one line that names the file. Other
/// exceptions go on as they are.
[[noreturn]] void refuse_bag(const std::string& file);

}  // namespace mrhi
