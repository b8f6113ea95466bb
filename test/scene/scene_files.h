#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "mr_hand_interaction/scene/scene_loader.h"
#include "support/temporary_folder.h"

namespace mrhi::test {

/// Makes a folder the working folder during its lifetime.
class WorkingFolder {
 public:
  explicit WorkingFolder(const std::string& folder) { std::filesystem::current_path(folder); }
  ~WorkingFolder() { std::filesystem::current_path(before_); }
  WorkingFolder(const WorkingFolder&) = delete;
  WorkingFolder& operator=(const WorkingFolder&) = delete;

 private:
  std::filesystem::path before_ = std::filesystem::current_path();
};

const char* const kInertial =
    R"(<inertial><mass value="0.1"/>
       <inertia ixx="1e-4" ixy="0" ixz="0" iyy="1e-4" iyz="0" izz="1e-4"/></inertial>)";
const char* const kBox = R"(<collision><geometry><box size="0.05 0.05 0.05"/></geometry></collision>)";

inline std::string link(const std::string& name, const std::string& content) {
  return "<link name=\"" + name + "\">" + content + "</link>\n";
}
inline std::string joint(const std::string& type, const std::string& parent, const std::string& child,
                         const std::string& origin = "") {
  return "<joint name=\"" + parent + "_" + child + "\" type=\"" + type + "\"><parent link=\"" + parent +
         "\"/><child link=\"" + child + "\"/><origin " + origin + "/><axis xyz=\"1 0 0\"/></joint>\n";
}
inline std::string robot(const std::string& content) {
  return "<robot name=\"test\"><link name=\"world\"/>\n" + content + "</robot>\n";
}
/// A scene of one free body named thing.
inline std::string thing(const std::string& content, const std::string& origin = "") {
  return robot(link("thing", content) + joint("floating", "world", "thing", origin));
}

/// The message with which loading fails, checked to be one line that begins with the file; else "".
inline std::string scene_error(const std::string& file, const SceneOptions& options = {}) {
  ::testing::internal::CaptureStderr();
  ::testing::internal::CaptureStdout();
  std::string message;
  try {
    load_scene(file, options);
  } catch (const SceneError& error) {
    message = error.what();
    EXPECT_EQ(std::string::npos, message.find('\n')) << message;
    EXPECT_EQ(0u, message.find(file.substr(0, file.rfind('.')))) << message;
  }
  EXPECT_EQ("", ::testing::internal::GetCapturedStderr()) << "the libraries must not print";
  EXPECT_EQ("", ::testing::internal::GetCapturedStdout()) << "the libraries must not print";
  return message;
}

inline std::string urdf_error(const std::string& xml) {
  const Folder folder;
  return scene_error(folder.write("s.urdf", xml));
}

inline void expect_words(const std::string& message, const std::vector<std::string>& words) {
  for (const std::string& word : words)
    EXPECT_NE(std::string::npos, message.find(word)) << word << "\n" << message;
}

/// A glTF of a tetrahedron with legs of 0.1 m, whose buffer is another file.
inline std::string gltf_of(const std::string& buffer) {
  return R"({"asset": {"version": "2.0"}, "buffers": [{"uri": ")" + buffer + R"(", "byteLength": 144}],
    "bufferViews": [{"buffer": 0, "byteLength": 144}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 12, "type": "VEC3",
                   "min": [0, 0, 0], "max": [0.1, 0.1, 0.1]}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}], "scene": 0})";
}

inline std::string gltf_buffer() {
  std::string bytes;
  for (const int corner : {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}) {
    for (int axis = 1; axis <= 3; ++axis) {
      const float place = axis == corner ? 0.1f : 0.0f;
      bytes.append(reinterpret_cast<const char*>(&place), sizeof place);
    }
  }
  return bytes;
}

/// Volume by the divergence theorem: positive if all triangles are turned outward [m^3].
inline double volume(const TriangleMesh& mesh) {
  double six_volumes = 0;
  for (const auto& t : mesh.triangles) {
    six_volumes += mesh.vertices[t[0]].cross(mesh.vertices[t[1]]).dot(mesh.vertices[t[2]]);
  }
  return six_volumes / 6;
}

}  // namespace mrhi::test
