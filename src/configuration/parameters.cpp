#include "mr_hand_interaction/parameters.h"

#include <set>

#include "../scene/limits.h"
#include "../text/text.h"
#include "../text/yaml.h"
#include "parameter_table.h"

namespace mrhi {
namespace {

const ParameterEntry& entry_of(const std::string& name) {
  for (const ParameterEntry& entry : parameter_table()) {
    if (entry.name == name) return entry;
  }
  throw ParameterError("unknown parameter '" + text::one_line(name, 60) +
                       "'; allowed: " + text::joined(parameter_names()));
}

void assign(Configuration& configuration, const std::string& name, const YAML::Node& node) {
  const ParameterEntry& entry = entry_of(name);
  if (entry.assign(configuration, node)) return;
  throw ParameterError("parameter '" + name + "': " + yaml_text(node) +
                       " is not allowed; allowed: " + entry.allowed);
}

/// Sets what a map holds; maps in it are name spaces.
class FileReader {
 public:
  FileReader(const std::string& file, Configuration& configuration)
      : file_(file), configuration_(configuration) {}

  void read(const YAML::Node& map, const std::string& prefix) {
    for (const auto& entry : map) {
      const std::string name = prefix + yaml_text(entry.first);
      if (entry.second.IsMap()) {
        read(entry.second, name + "/");
      } else {
        set(name, entry.second);
      }
    }
  }

 private:
  void set(const std::string& name, const YAML::Node& node) {
    try {
      if (!seen_.insert(name).second) {
        throw ParameterError("parameter '" + name + "' is given twice; allowed: once");
      }
      assign(configuration_, name, node);
    } catch (const ParameterError& error) {
      throw ParameterError(yaml_place(file_, node.Mark()) + ": " + error.what());
    }
  }

  const std::string& file_;
  Configuration& configuration_;
  std::set<std::string> seen_;
};

}  // namespace

void set_parameter(Configuration& configuration, const std::string& name, const std::string& yaml_value) {
  try {
    const std::string what =
        "parameter '" + text::one_line(name, 60) + "': '" + text::one_line(yaml_value, 60) + "'";
    assign(configuration, name, load_yaml(what, yaml_value));
  } catch (const YamlError& error) {
    throw ParameterError(error.what());
  }
}

void load_parameters(Configuration& configuration, const std::string& yaml_file) {
  read_yaml<ParameterError>(yaml_file, [&] {
    const YAML::Node root = load_yaml_file(yaml_file);
    if (!root.IsMap() && !root.IsNull()) {
      throw ParameterError(yaml_file + ": " + yaml_text(root) +
                           " is not allowed; allowed: a map of parameters");
    }
    Configuration changed = configuration;
    FileReader(yaml_file, changed).read(root, "");
    configuration = changed;
  });
}

void validate(const Configuration& configuration) {
  Configuration copy = configuration;
  for (const ParameterEntry& entry : parameter_table()) {
    if (entry.limits) assign(copy, entry.name, YAML::Load(entry.text(configuration)));
  }
  if (const auto conflict = material_conflict(configuration.material)) {
    throw ParameterError("parameter 'material/dynamic_friction': " + *conflict);
  }
}

std::string parameter_text(const Configuration& configuration, const std::string& name) {
  return entry_of(name).text(configuration);
}

std::optional<ParameterLimits> parameter_limits(const std::string& name) {
  return entry_of(name).limits;
}

std::vector<std::string> parameter_names() {
  std::vector<std::string> names;
  for (const ParameterEntry& entry : parameter_table()) names.push_back(entry.name);
  return names;
}

}  // namespace mrhi
