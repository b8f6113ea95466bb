#pragma once

#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

#include "change.h"

namespace mrhi {

// Parts of recorded YAML that changes and worlds share. Numbers keep their bits. Readers throw
// std::invalid_argument with one line.
YAML::Node numbers_node(const std::vector<double>& values);
YAML::Node pose_node(const Pose& pose);
YAML::Node twist_node(const Twist& twist);
YAML::Node request_node(const ObjectRequest& request);

std::vector<double> numbers_in(const YAML::Node& node, std::size_t count);
Pose pose_in(const YAML::Node& node);
Twist twist_in(const YAML::Node& node);
ObjectRequest request_in(const YAML::Node& node, const RecordedFiles& files);

/// What `read` gives; where a part has another form than it needs, as a text where a map should be, that is
/// reported in our words.
[[noreturn]] void refuse_form();
template <class Read>
auto in_form(const Read& read) {
  try {
    return read();
  } catch (const YAML::Exception&) {
    refuse_form();
  }
}

/// Of recorded YAML, which may be long.
YAML::Node recorded_yaml(const std::string& yaml);
/// Text of a node that must be there.
std::string text_in(const YAML::Node& node, const char* key);
const RecordedFile* find_file(const RecordedFiles& files, const std::string& name);
std::string spawned_file(const ObjectRequest& request);

}  // namespace mrhi
