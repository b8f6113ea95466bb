#pragma once

#include <assimp/DefaultIOSystem.h>
#include <cstdint>
#include <filesystem>
#include <set>
#include <string>

namespace mrhi {

constexpr std::uintmax_t kMaxMeshBytes = 64u << 20;  ///< of a mesh file, and of each file that it names

/// Reason why a file is too large; empty: it is not, or it is not there.
std::string why_too_large(const std::filesystem::path& file);

/// File system of assimp for one mesh, which may name other files: opens a glTF's buffers alone (.bin), and
/// only in or below the mesh's own folder. What is read is published and recorded, and a mesh may come from a
/// stranger.
class MeshFileSystem : public Assimp::DefaultIOSystem {
 public:
  explicit MeshFileSystem(const std::string& mesh_file);

  bool Exists(const char* file) const override;
  /// Returns null for a file that is refused or missing.
  Assimp::IOStream* Open(const char* file, const char* mode = "rb") override;

  /// Opened files besides the mesh, relative to its folder.
  const std::set<std::string>& opened() const { return opened_; }
  /// Reason why a file was refused, with its name; continues a message after the mesh's name. Empty: none.
  const std::string& refusal() const { return refusal_; }
  /// Name of the last file that is not there; empty: none.
  const std::string& missing() const { return missing_; }

 private:
  std::string why_refused(const std::filesystem::path& file) const;

  std::filesystem::path mesh_;
  bool has_buffers_;  ///< of a glTF; what other formats name, materials and images, is not used
  std::set<std::filesystem::path> folders_;  ///< of the mesh and of the target of a symlink to it
  std::set<std::string> opened_;
  std::string refusal_;
  mutable std::string missing_;
};

}  // namespace mrhi
