#pragma once

#include <yaml-cpp/yaml.h>
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// Error of rejected YAML. what() is one line with the source first and what is allowed.
class YamlError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Loads untrusted YAML: at most 256 KiB, 32 levels deep, without aliases. This excludes short texts that
/// expand to millions of nodes, and values that contain themselves. All limits are checked before parsing.
/// Throws YamlError.
YAML::Node load_yaml_file(const std::string& file);

/// The same from a text of at most `max_bytes`; `source` is its name in messages.
YAML::Node load_yaml(const std::string& source, const std::string& yaml, std::size_t max_bytes = 256 * 1024);

/// yaml-cpp's message as one line with the place.
std::string yaml_complaint(const std::string& source, const YAML::Exception& error);

/// Returns the result of `read`; converts its YAML exceptions to Error.
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

/// Range of a setting's number: both ends finite, max included.
struct Range {
  constexpr Range(double lowest, double highest, bool lowest_allowed = true)
      : min(lowest), max(highest), min_allowed(lowest_allowed) {}

  double min, max;
  bool min_allowed;

  bool contains(double value) const;
  std::string describe() const;  ///< "a number from 0 to 1"
};

/// Typed readers: empty if the node has another type or is not finite.
std::optional<double> yaml_number(const YAML::Node& node);
std::optional<int> yaml_integer(const YAML::Node& node);
std::optional<Vector3> yaml_vector(const YAML::Node& node);
/// A sequence of `size` numbers.
std::optional<std::vector<double>> yaml_numbers(const YAML::Node& node, std::size_t size);

/// Numbers on one line, with exact bits.
YAML::Node yaml_list(const std::vector<double>& values);

/// The node as one line of YAML, for messages.
std::string yaml_text(const YAML::Node& node);
/// The texts of a sequence in a YAML text.
std::vector<std::string> yaml_texts(const std::string& source, const std::string& yaml);

/// "FILE:LINE" of a node.
std::string yaml_place(const std::string& file, const YAML::Mark& mark);

/// A node and its path in the file ("materials/cube"), for messages. Errors throw InputError.
struct YamlElement {
  const std::string& file;
  std::string path;
  YAML::Node node;

  YamlElement at(const std::string& key) const;
  YamlElement at(std::size_t index) const;  ///< of a sequence; its path counts from 1
  [[noreturn]] void fail(const std::string& what) const;
  [[noreturn]] void refuse(const std::string& allowed) const;
};

/// Keys of a map; throws for an unknown or repeated one.
std::vector<std::string> checked_keys(const YamlElement& map, const std::vector<std::string>& known);

/// A number in the range; the message ends with `unit`: " [s]".
double read_number(const YamlElement& element, const Range& range, const char* unit);

/// Three numbers, each in the range; by default a position in m.
Vector3 read_vector(const YamlElement& element, const Range& range = {-1000, 1000});

}  // namespace mrhi
