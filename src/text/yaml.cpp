#include "yaml.h"

#include <yaml-cpp/eventhandler.h>
#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "files.h"
#include "mr_hand_interaction/input_error.h"
#include "text.h"

namespace mrhi {
namespace {

constexpr std::size_t kMaxBytes = 256 * 1024;
constexpr int kMaxYamlDepth = 32;

/// Scans a document without building it.
class Guard : public YAML::EventHandler {
 public:
  explicit Guard(const std::string& source) : source_(source) {}

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    refuse(mark, "an alias is not allowed; allowed: the value itself");
  }
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t, const std::string&) override {}
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {
    enter(mark);
  }
  void OnSequenceEnd() override { --depth_; }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {
    enter(mark);
  }
  void OnMapEnd() override { --depth_; }

 private:
  void enter(const YAML::Mark& mark) {
    if (++depth_ > kMaxYamlDepth)
      refuse(mark,
             "is nested deeper than " + std::to_string(kMaxYamlDepth) + " levels; allowed: at most that");
  }
  [[noreturn]] void refuse(const YAML::Mark& mark, const std::string& what) const {
    throw YamlError(yaml_place(source_, mark) + ": " + what);
  }

  const std::string& source_;
  int depth_ = 0;
};

/// yaml-cpp up to 0.6.3 exhausts memory for a colon that ends the text within braces. Before a new line it
/// reports that these are not closed.
std::string ended(const std::string& yaml) {
  return !yaml.empty() && yaml.back() == ':' ? yaml + '\n' : yaml;
}

}  // namespace

std::string yaml_complaint(const std::string& source, const YAML::Exception& error) {
  return yaml_place(source, error.mark) +
         ": not YAML: a bracket, brace, quote, colon or indentation is missing or in a wrong place; allowed: "
         "YAML such as 'key: [1, 2]' (the parser says: " +
         text::one_line(error.msg) + ")";
}

YAML::Node load_yaml(const std::string& source, const std::string& yaml, std::size_t max_bytes) {
  if (yaml.size() > max_bytes)
    throw YamlError(source + ": is longer than " + std::to_string(max_bytes) +
                    " bytes; allowed: at most that");
  try {
    const std::string whole = ended(yaml);
    std::istringstream text(whole);
    YAML::Parser parser(text);
    Guard guard(source);
    parser.HandleNextDocument(guard);
    if (parser.HandleNextDocument(guard))
      throw YamlError(source + ": has a second document, below '---'; allowed: one");
    return YAML::Load(whole);
  } catch (const YAML::Exception& error) {
    throw YamlError(yaml_complaint(source, error));
  }
}

YAML::Node load_yaml_file(const std::string& file) {
  const std::optional<std::string> text = file_text(file, kMaxBytes + 1);
  if (!text) throw YamlError(file + ": cannot be read; allowed: a readable YAML file");
  return load_yaml(file, *text);
}

bool Range::contains(double value) const {
  return (min_allowed ? value >= min : value > min) && value <= max;  // false for NaN
}

std::string Range::describe() const {
  const std::string low = text::number(min), high = text::number(max);
  return min_allowed ? "a number from " + low + " to " + high : "a number above " + low + ", at most " + high;
}

std::optional<double> yaml_number(const YAML::Node& node) {
  double value = 0;
  if (!node.IsScalar() || !YAML::convert<double>::decode(node, value) || !std::isfinite(value)) return {};
  return value;
}

std::optional<int> yaml_integer(const YAML::Node& node) {
  int value = 0;
  if (!node.IsScalar() || !YAML::convert<int>::decode(node, value)) return {};
  return value;
}

std::optional<std::vector<double>> yaml_numbers(const YAML::Node& node, std::size_t size) {
  if (!node.IsSequence() || node.size() != size) return {};
  std::vector<double> numbers;
  for (const auto& item : node) {
    const std::optional<double> value = yaml_number(item);
    if (!value) return {};
    numbers.push_back(*value);
  }
  return numbers;
}

std::optional<Vector3> yaml_vector(const YAML::Node& node) {
  const auto numbers = yaml_numbers(node, 3);
  return numbers ? std::make_optional<Vector3>(numbers->data()) : std::nullopt;
}

YAML::Node yaml_list(const std::vector<double>& values) {
  YAML::Node node(YAML::NodeType::Sequence);
  for (const double value : values) node.push_back(text::exact(value));
  node.SetStyle(YAML::EmitterStyle::Flow);
  return node;
}

std::string yaml_text(const YAML::Node& node) {
  if (node.IsNull()) return "nothing";
  return text::one_line(node.IsScalar() ? node.Scalar() : YAML::Dump(node), 60);
}

std::vector<std::string> yaml_texts(const std::string& source, const std::string& yaml) {
  std::vector<std::string> texts;
  for (const YAML::Node& item : load_yaml(source, yaml)) texts.push_back(yaml_text(item));
  return texts;
}

std::string yaml_place(const std::string& file, const YAML::Mark& mark) {
  return mark.is_null() ? file : file + ":" + std::to_string(mark.line + 1);
}

YamlElement YamlElement::at(const std::string& key) const {
  return {file, path.empty() ? key : path + "/" + key, node[key]};
}

YamlElement YamlElement::at(std::size_t index) const {
  return {file, path + "/" + std::to_string(index + 1), node[index]};
}

void YamlElement::fail(const std::string& what) const {
  throw InputError(yaml_place(file, node.Mark()) + ": " + path + (path.empty() ? "" : ": ") + what);
}

void YamlElement::refuse(const std::string& allowed) const {
  fail(yaml_text(node) + " is not allowed; allowed: " + allowed);
}

std::vector<std::string> checked_keys(const YamlElement& map, const std::vector<std::string>& known) {
  if (!map.node.IsMap()) map.refuse("a map with the keys " + text::joined(known));
  std::vector<std::string> keys;
  std::set<std::string> seen;
  for (const auto& entry : map.node) {
    const std::string key = yaml_text(entry.first);
    if (std::find(known.begin(), known.end(), key) == known.end()) {
      map.fail("unknown key '" + key + "'; allowed: " + text::joined_or_none(known));
    }
    if (!seen.insert(key).second) map.fail("key '" + key + "' is given twice; allowed: once");
    keys.push_back(key);
  }
  return keys;
}

double read_number(const YamlElement& element, const Range& range, const char* unit) {
  const std::optional<double> value = yaml_number(element.node);
  if (!value || !range.contains(*value)) element.refuse(range.describe() + unit);
  return *value;
}

Vector3 read_vector(const YamlElement& element, const Range& range) {
  const std::optional<Vector3> vector = yaml_vector(element.node);
  if (!vector || !range.contains(vector->minCoeff()) || !range.contains(vector->maxCoeff()))
    element.refuse("three numbers [x, y, z] from " + text::number(range.min) + " to " +
                   text::number(range.max));
  return *vector;
}

}  // namespace mrhi
