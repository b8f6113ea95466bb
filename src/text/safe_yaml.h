#pragma once

#include <yaml-cpp/yaml.h>

#include <cstddef>
#include <stdexcept>
#include <string>

namespace mrhi {

/// YAML that is not taken. what() is one line that begins with the source and says what is allowed.
class YamlError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// YAML from who knows where: at most 256 KiB, 32 levels deep, without aliases, so that neither a few bytes
/// that stand for millions nor a value that holds itself gets in. All of it is checked before anything is
/// built. Throws YamlError.
YAML::Node load_yaml_file(const std::string& file);

/// The same from a text; `source` names it in messages.
YAML::Node load_yaml(const std::string& source, const std::string& yaml);
/// Or of at most that many bytes.
YAML::Node load_yaml(const std::string& source, const std::string& yaml, std::size_t most);

/// yaml-cpp's word as one line with the place.
std::string yaml_complaint(const std::string& source, const YAML::Exception& error);

/// What `read` gives; what it throws of YAML is an Error.
template <typename Error, typename Read>
auto read_yaml(const std::string& source, const Read& read) {
  try {
    return read();
  } catch (const YamlError& error) {
    throw Error(error.what());
  } catch (const YAML::Exception& error) {
    throw Error(yaml_complaint(source, error));
  }
}

}  // namespace mrhi
