#include "change_yaml.h"

#include <cstdint>
#include <cstdlib>
#include <stdexcept>

#include "../text/safe_yaml.h"
#include "../text/text.h"

namespace mrhi {
namespace {

constexpr std::size_t kMostBytes = 4u << 20;

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument("recorded change: " + what + "; allowed: what this package has recorded");
}

}  // namespace

YAML::Node recorded_yaml(const std::string& yaml) {
  try {
    return load_yaml("recorded change", yaml, kMostBytes);
  } catch (const YamlError& error) {
    throw std::invalid_argument(error.what());
  }
}

std::string text_in(const YAML::Node& node, const char* key) {
  const YAML::Node value = node.IsMap() ? node[key] : YAML::Node(YAML::NodeType::Undefined);
  if (!value || !value.IsScalar()) refuse(std::string("no '") + key + "'");
  return value.Scalar();
}

const RecordedFile* find_file(const RecordedFiles& files, const std::string& name) {
  for (const RecordedFile& file : files)
    if (file.name == name) return &file;
  return nullptr;
}

/// What is spawned whole may have no name: its text names it (FNV-1a).
std::string spawned_file(const ObjectRequest& request) {
  std::string name = request.name;
  if (name.empty()) {
    std::uint64_t sum = 0xcbf29ce484222325u;
    for (const char c : request.urdf) sum = (sum ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
    name = std::to_string(sum);
  }
  return "spawn/" + name + ".urdf";
}

YAML::Node numbers_node(const std::vector<double>& values) {
  YAML::Node node(YAML::NodeType::Sequence);
  for (const double value : values) node.push_back(text::exact(value));
  node.SetStyle(YAML::EmitterStyle::Flow);
  return node;
}

YAML::Node pose_node(const Pose& pose) {
  const Vector3& p = pose.position;
  const Quaternion& q = pose.orientation;
  return numbers_node({p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()});
}

YAML::Node twist_node(const Twist& twist) {
  const Vector3 &v = twist.linear, &w = twist.angular;
  return numbers_node({v.x(), v.y(), v.z(), w.x(), w.y(), w.z()});
}

YAML::Node request_node(const ObjectRequest& request) {
  YAML::Node node;
  node["name"] = request.name;
  if (!request.urdf.empty()) node["urdf"] = spawned_file(request);
  if (request.urdf.empty()) {
    node["shape"] = request.shape;
    node["size"] = numbers_node(request.size);
    node["mass"] = text::exact(request.mass);
  }
  if (request.whole) {
    node["whole"] = "yes";
    node["joints"] = request.joints;
  }
  node["pose"] = pose_node(request.pose);
  node["twist"] = twist_node(request.twist);
  if (!request.material.empty()) node["material"] = request.material;
  if (request.rgba) {
    const auto& c = *request.rgba;
    node["rgba"] = numbers_node({double(c[0]), double(c[1]), double(c[2]), double(c[3])});
  }
  return node;
}

std::vector<double> numbers_in(const YAML::Node& node, std::size_t count) {
  if (!node || !node.IsSequence() || (count > 0 && node.size() != count) || node.size() > 100)
    refuse("not " + std::to_string(count) + " numbers");
  std::vector<double> values;
  for (const YAML::Node& item : node) {
    const std::string text = item.IsScalar() ? item.Scalar() : "";
    char* end = nullptr;
    values.push_back(std::strtod(text.c_str(), &end));
    if (text.empty() || *end != '\0') refuse("'" + text::one_line(text, 40) + "' is no number");
  }
  return values;
}

Pose pose_in(const YAML::Node& node) {
  const std::vector<double> v = numbers_in(node, 7);
  return {{v[0], v[1], v[2]}, Quaternion(v[6], v[3], v[4], v[5])};
}

Twist twist_in(const YAML::Node& node) {
  const std::vector<double> v = numbers_in(node, 6);
  return {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
}

ObjectRequest request_in(const YAML::Node& node, const RecordedFiles& files) {
  ObjectRequest request;
  request.name = text_in(node, "name");
  if (node["urdf"]) {
    const RecordedFile* file = find_file(files, text_in(node, "urdf"));
    if (file == nullptr) refuse("the URDF of '" + text::one_line(request.name, 60) + "' is missing");
    request.urdf = file->bytes;
  } else {
    request.shape = text_in(node, "shape");
    request.size = numbers_in(node["size"], 0);
    request.mass = numbers_in(YAML::Node(std::vector<std::string>{text_in(node, "mass")}), 1)[0];
  }
  if (node["whole"]) {
    request.whole = true;
    request.joints = text_in(node, "joints");
  }
  request.pose = pose_in(node["pose"]);
  request.twist = twist_in(node["twist"]);
  if (node["material"]) request.material = text_in(node, "material");
  if (node["rgba"]) {
    const std::vector<double> c = numbers_in(node["rgba"], 4);
    request.rgba = {{float(c[0]), float(c[1]), float(c[2]), float(c[3])}};
  }
  return request;
}

}  // namespace mrhi
