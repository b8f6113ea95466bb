#include "mesh_file_system.h"

#include <algorithm>

#include "../text/files.h"
#include "../text/text.h"

namespace mrhi {
namespace {

namespace fs = std::filesystem;

fs::path plain(const fs::path& file) {
  std::error_code ignored;
  return fs::absolute(file, ignored).lexically_normal();
}

bool is_buffer(const fs::path& file) {
  return text::in_lower_case(file.extension().string()) == ".bin";
}

bool is_below(const fs::path& folder, const fs::path& file) {
  return std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first == folder.end();
}

}  // namespace

std::string why_too_large(const fs::path& file) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(file, error);
  if (error || size <= kMaxMeshBytes) return "";
  return "has " + std::to_string(size) + " bytes; allowed: at most " + std::to_string(kMaxMeshBytes);
}

MeshFileSystem::MeshFileSystem(const std::string& mesh_file)
    : mesh_(plain(mesh_file)), has_buffers_(text::in_lower_case(mesh_.extension().string()) == ".gltf") {
  std::error_code ignored;
  folders_ = {fs::weakly_canonical(mesh_.parent_path(), ignored),
              fs::weakly_canonical(mesh_, ignored).parent_path()};
}

bool MeshFileSystem::Exists(const char* file) const {
  const fs::path path = plain(file);
  if (path != mesh_ && !has_buffers_) return false;
  if (!is_file(path)) missing_ = path.filename().string();
  return is_file(path) && why_refused(path).empty();
}

Assimp::IOStream* MeshFileSystem::Open(const char* file, const char* mode) {
  const fs::path path = plain(file);
  std::error_code ignored;
  if (*mode != 'r') return nullptr;
  if (path != mesh_ && !has_buffers_) return nullptr;
  if (!fs::exists(path, ignored)) {
    missing_ = path.filename().string();
    return nullptr;
  }
  const std::string why = why_refused(path), name = path.lexically_relative(mesh_.parent_path()).string();
  if (!why.empty() && refusal_.empty())
    refusal_ = "names the file " + text::quoted(name, 120) + ", which " + why;
  if (!why.empty()) return nullptr;
  if (path != mesh_) opened_.insert(name);
  return DefaultIOSystem::Open(path.c_str(), mode);
}

std::string MeshFileSystem::why_refused(const fs::path& file) const {
  std::error_code error;
  const fs::path target = fs::weakly_canonical(file, error);
  const bool is_inside = std::any_of(folders_.begin(), folders_.end(),
                                     [&](const fs::path& folder) { return is_below(folder, target); });
  if (file != mesh_ && (error || !is_inside))
    return "is not in the mesh's folder; allowed: files in or below that folder";
  if (file != mesh_ && !(is_buffer(file) && is_buffer(target)))
    return "is no buffer; allowed: files that end in .bin";
  const std::string why = why_unreadable(file.string());
  if (!why.empty()) return why + "; allowed: a file that may be read";
  return why_too_large(file);
}

}  // namespace mrhi
