#include "mr_hand_interaction/training/session_setup.h"

#include <openssl/sha.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "../text/file_text.h"
#include "../text/text.h"
#include "mr_hand_interaction/parameters.h"
#include "mr_hand_interaction/training/session_folder.h"

namespace mrhi {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargestMesh = std::size_t{256} << 20;  // of a mesh
constexpr std::size_t kShown = 60, kBefore = 30;              // of a line that differs
const char* const kSums = "SHA256SUMS";
const char* const kAllowed = "; allowed: the same, or another folder";

std::string bytes_of(const std::string& file) {
  std::optional<std::string> text = file_text(file, kLargestMesh + 1);
  if (!text || text->size() > kLargestMesh)
    throw SceneError(file + ": cannot be read; allowed: a readable file of at most 256 MB");
  return *std::move(text);
}

/// As `sha256sum` prints it.
std::string sha256(const std::string& bytes) {
  std::array<unsigned char, SHA256_DIGEST_LENGTH> digest;
  SHA256(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(), digest.data());
  std::string digits;
  for (const unsigned char byte : digest) {
    digits += "0123456789abcdef"[byte >> 4];
    digits += "0123456789abcdef"[byte & 0xf];
  }
  return digits;
}

std::string parameters_text(const Configuration& configuration) {
  std::string all;
  for (const std::string& name : parameter_names())
    all += name + ": " + parameter_text(configuration, name) + '\n';
  return all;
}

std::string mesh_file(const std::string& uri, const SceneOptions& options) {
  const std::string kFile = "file://";
  return uri.compare(0, kFile.size(), kFile) == 0 ? uri.substr(kFile.size())
                                                  : options.resolve_package_uri(uri);
}

/// A line for each mesh of the bodies, by the name of its file: where a package lies may change.
void add_meshes(const Scene& scene, const SceneOptions& options, std::map<std::string, std::string>& sums) {
  const auto add = [&](const auto& shapes) {
    for (const auto& placed : shapes) {
      const auto* mesh = std::get_if<Mesh>(&placed.shape);
      if (mesh == nullptr) continue;
      const std::string file = mesh_file(mesh->uri, options);
      sums[fs::path(file).filename().string()] = sha256(bytes_of(file));
    }
  };
  for (const Body& body : scene.bodies) {
    add(body.shapes);
    add(body.visuals);
  }
}

std::string list_of(const std::map<std::string, std::string>& sums) {
  std::string all;
  for (const auto& [name, sum] : sums) all.append(sum).append("  ").append(name).append("\n");
  return all;
}

std::string sums_of(const SessionSetup& setup) {
  std::map<std::string, std::string> sums;
  for (const auto& [name, text] : setup.files) sums[name] = sha256(text);
  return list_of(sums);
}

/// Files of two scenes may have the same name.
std::string free_name(const SessionSetup& setup, const std::string& object, const std::string& ending) {
  const std::string name = "scenes/" + object + ending;
  return setup.files.count(name) == 0 ? name : "scenes/fixture_" + object + ending;
}

void write_whole(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream out(file, std::ios::binary);
  out << text << std::flush;
  if (!out)
    throw SessionError(file.string() + ": cannot be written; allowed: a folder to write to with space left");
}

/// From shortly before where it differs.
std::string shown(const std::string& line, std::size_t differs) {
  const std::size_t from = differs > kBefore ? differs - kBefore : 0;
  return (from > 0 ? "'..." : "'") + text::one_line(line.substr(from), kShown) + "'";
}

std::size_t first_difference(const std::string& a, const std::string& b) {
  const std::size_t shorter = std::min(a.size(), b.size());
  return static_cast<std::size_t>(
      std::mismatch(a.begin(), a.begin() + static_cast<std::ptrdiff_t>(shorter), b.begin()).first -
      a.begin());
}

/// `there` and `here` differ.
[[noreturn]] void refuse(const std::string& file, const std::string& there, const std::string& here) {
  std::istringstream a(there), b(here);
  std::string of_a, of_b;
  int number = 0;
  bool more = true;
  while (more && of_a == of_b) {
    ++number;
    const bool more_a = static_cast<bool>(std::getline(a, of_a)),
               more_b = static_cast<bool>(std::getline(b, of_b));
    if (!more_a) of_a = "no such line";
    if (!more_b) of_b = "no such line";
    more = more_a || more_b;
  }
  const std::size_t differs = first_difference(of_a, of_b);
  throw SessionError(file + ":" + std::to_string(number) + ": the session in this folder was begun with " +
                     shown(of_a, differs) + ", this one has " + shown(of_b, differs) + kAllowed);
}

/// What people read comes before the sums, which differ wherever anything does.
std::vector<std::string> in_order(const SessionSetup& setup) {
  std::vector<std::string> names{"parameters.yaml", "task.yaml", "software.yaml"};
  for (const auto& [name, text] : setup.files) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  names.erase(std::remove(names.begin(), names.end(), kSums), names.end());
  names.emplace_back(kSums);
  return names;
}

}  // namespace

SessionSetup session_setup(const std::string& task_file, const Task& task, Configuration configuration,
                           const std::vector<std::string>& scene_folders, const SceneOptions& options,
                           const std::string& version) {
  SessionSetup setup;
  std::map<std::string, std::string> meshes;
  const auto add = [&](const std::string& name, const std::string& scene) {
    const std::string urdf = find_scene_file(scene, scene_folders);
    setup.files[free_name(setup, name, ".urdf")] = bytes_of(urdf);
    const fs::path yaml = fs::path(urdf).replace_extension(".yaml");
    if (fs::exists(yaml)) setup.files[free_name(setup, name, ".yaml")] = bytes_of(yaml.string());
    add_meshes(load_scene(urdf, options), options, meshes);
  };
  for (const TaskObject& object : task.objects) add(object.name, object.file);
  for (const Fixture& fixture : task.fixtures) add(fixture.name, fixture.file);
  if (!task.scene.empty()) add(fs::path(task.scene).stem().string(), task.scene);
  configuration.gravity = task.gravity;
  setup.files["task.yaml"] = bytes_of(task_file);
  setup.files["parameters.yaml"] = parameters_text(configuration);
  setup.files["software.yaml"] = "version: " + version + "\nrevision: " + source_revision() + "\n";
  if (!meshes.empty()) setup.files["meshes.txt"] = list_of(meshes);
  setup.files[kSums] = sums_of(setup);
  return setup;
}

void write_setup(const std::string& folder, const SessionSetup& setup) {
  if (setup.files.empty()) return;
  try {
    const fs::path kept = fs::path(folder) / "setup", unfinished = fs::path(folder) / "setup.part";
    fs::remove_all(unfinished);
    for (const auto& [name, text] : setup.files) write_whole(unfinished / name, text);
    fs::remove_all(kept);
    fs::rename(unfinished, kept);
  } catch (const fs::filesystem_error& error) {
    throw SessionError(folder + ": setup cannot be written: " + error.code().message());
  }
}

void check_same_setup(const std::string& folder, const SessionSetup& setup) {
  if (setup.files.empty()) return;
  const std::string kept = folder + "/setup/";
  if (!fs::is_directory(kept))
    throw SessionError(folder + ": the session in this folder was begun without a record of its task, " +
                       "parameters and software (setup)" + kAllowed);
  for (const std::string& name : in_order(setup)) {
    const auto here = setup.files.find(name);
    const std::string there = file_text(kept + name, kLargestMesh).value_or("");
    const std::string wanted = here == setup.files.end() ? "" : here->second;
    if (there != wanted) refuse(kept + name, there, wanted);
  }
}

}  // namespace mrhi
