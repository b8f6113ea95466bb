#pragma once

#include <optional>
#include <string>
#include <vector>

namespace mrhi {

/// The first `most` bytes of a regular file, or nothing if it cannot be read.
std::optional<std::string> file_text(const std::string& file, std::size_t most);

/// The file that `name` means: a path to a file with this extension (".urdf"), or a name looked up as
/// DIRECTORY/NAME.urdf. Throws SceneError that says what `kind` of file it is ("scene") and lists the names
/// known.
std::string find_named_file(const std::string& kind, const std::string& name, const std::string& extension,
                            const std::vector<std::string>& directories);

}  // namespace mrhi
