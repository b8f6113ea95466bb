#pragma once

#include <string>

#include "change.h"

namespace mrhi {

/// What `xml` names as filename="...", as far as it can be read; paths are from `folder` on.
RecordedFiles mesh_files(const std::string& xml, const std::string& folder);

/// The same XML with those of `files` that it names replaced by where `folder` has them, which is where they
/// are written.
std::string with_meshes_in(const std::string& folder, std::string xml, const RecordedFiles& files);

}  // namespace mrhi
