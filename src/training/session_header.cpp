#include "session_header.h"

#include <yaml-cpp/yaml.h>

#include <utility>

#include "../text/safe_yaml.h"
#include "../text/text.h"
#include "../text/yaml_values.h"

namespace mrhi {
namespace {

constexpr int kVersion = 1;

using Field = std::pair<const char*, std::string>;

/// What makes a session the one that it is, beside its gravity.
std::vector<Field> identity(const SessionHeader& header) {
  return {{"participant", header.participant},
          {"group", header.group},
          {"handedness", header.handedness},
          {"condition", header.condition},
          {"seed", std::to_string(header.seed)},
          {"task", header.task},
          {"session", std::to_string(header.session)},
          {"simulated", header.simulated ? "true" : "false"},
          {"order", "[" + text::joined(header.order) + "]"}};
}

std::string field_text(const YAML::Node& node) {
  if (!node.IsSequence()) return node ? yaml_text(node) : "nothing";
  std::vector<std::string> items;
  for (const auto& item : node) items.push_back(yaml_text(item));
  return "[" + text::joined(items) + "]";
}

[[noreturn]] void refuse(const std::string& file, const std::string& key, const std::string& there,
                         const std::string& here) {
  throw SessionError(file + ": " + key + ": the session in this folder has " + there + ", this one " + here +
                     "; allowed: the same, or another folder");
}

void check_word(const char* key, const std::string& value) {
  if (!is_name(value))
    throw SessionError(std::string(key) + " '" + text::one_line(value, 60) +
                       "' is not allowed; allowed: a name of " + kNameIs);
}

}  // namespace

void check_header(const SessionHeader& header) {
  check_word("participant", header.participant);
  check_word("condition", header.condition);
  check_word("group", header.group);
  if (header.handedness != "right" && header.handedness != "left")
    throw SessionError("handedness '" + header.handedness + "' is not allowed; allowed: right or left");
}

std::string header_text(const SessionHeader& header) {
  YAML::Emitter out;
  out << YAML::BeginMap << YAML::Key << "version" << YAML::Value << kVersion;
  const auto quoted = [&out](const char* key, const std::string& value) {
    out << YAML::Key << key << YAML::Value << YAML::DoubleQuoted << value;
  };
  quoted("participant", header.participant);
  quoted("group", header.group);
  out << YAML::Key << "handedness" << YAML::Value << header.handedness;
  quoted("condition", header.condition);
  out << YAML::Key << "gravity" << YAML::Value << YAML::Flow << YAML::BeginSeq;
  for (const double g : {header.gravity.x(), header.gravity.y(), header.gravity.z()}) out << g;
  out << YAML::EndSeq << YAML::Key << "seed" << YAML::Value << header.seed;
  quoted("task", header.task);
  out << YAML::Key << "session" << YAML::Value << header.session;
  out << YAML::Key << "simulated" << YAML::Value << header.simulated;
  quoted("started", header.started);
  out << YAML::Key << "order" << YAML::Value << YAML::Flow << header.order;
  quoted("software", header.software);
  out << YAML::EndMap;
  return std::string(out.c_str()) + "\n";
}

void check_same_session(const std::string& file, const SessionHeader& header) {
  read_yaml<SessionError>(file, [&] {
    const YAML::Node there = load_yaml_file(file);
    if (!there.IsMap())
      throw SessionError(file + ": is not a list of keys with values; allowed: a session's header");
    for (const auto& [key, here] : identity(header)) {
      const bool first = std::string(key) == "session" && !there[key];  // before there were several
      const std::string said = first ? "1" : field_text(there[key]);
      if (said != here) refuse(file, key, "'" + said + "'", "'" + here + "'");
    }
    const std::optional<Vector3> gravity = yaml_vector(there["gravity"]);
    if (!gravity || *gravity != header.gravity)
      refuse(file, "gravity", field_text(there["gravity"]), text::vector(header.gravity));
  });
}

}  // namespace mrhi
