#include "urdf_meshes.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <stdexcept>

#include "../text/file_text.h"
#include "mr_hand_interaction/ros/package_paths.h"

namespace mrhi {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostBytes = 64u << 20;  // of a mesh

bool begins_with(const std::string& text, const std::string& prefix) {
  return text.compare(0, prefix.size(), prefix) == 0;
}

std::string place_of(const std::string& uri, const std::string& folder) {
  if (begins_with(uri, "file://")) return uri.substr(7);
  if (begins_with(uri, "package://")) return resolve_package_uri(uri);
  return (fs::path(folder) / uri).string();
}

void replace_all(const std::string& from, const std::string& to, std::string& text) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
}

}  // namespace

RecordedFiles mesh_files(const std::string& xml, const std::string& folder) {
  static const std::regex kFilename("filename\\s*=\\s*[\"']([^\"']*)[\"']");
  RecordedFiles files;
  for (std::sregex_iterator found(xml.begin(), xml.end(), kFilename), end; found != end; ++found) {
    const std::string uri = (*found)[1];
    const bool known =
        std::any_of(files.begin(), files.end(), [&](const RecordedFile& file) { return file.name == uri; });
    const auto bytes = known ? std::nullopt : file_text(place_of(uri, folder), kMostBytes + 1);
    if (bytes && bytes->size() <= kMostBytes) files.push_back({uri, *bytes});
  }
  return files;
}

std::string with_meshes_in(const std::string& folder, std::string xml, const RecordedFiles& files) {
  for (std::size_t i = 0; i < files.size(); ++i) {
    const std::string& uri = files[i].name;
    if (xml.find('"' + uri + '"') == std::string::npos && xml.find('\'' + uri + '\'') == std::string::npos)
      continue;
    const fs::path path =
        fs::path(folder) / ("mesh_" + std::to_string(i) + fs::path(uri).extension().string());
    std::ofstream out = file_to_write(path.string());
    out << files[i].bytes << std::flush;
    if (!out) throw std::runtime_error("cannot write " + path.string());
    for (const char quote : {'"', '\''})
      replace_all(quote + uri + quote, quote + ("file://" + path.string()) + quote, xml);
  }
  return xml;
}

}  // namespace mrhi
