#include "safe_yaml.h"

#include <yaml-cpp/eventhandler.h>

#include <optional>
#include <sstream>

#include "file_text.h"
#include "text.h"
#include "yaml_values.h"

namespace mrhi {
namespace {

constexpr std::size_t kMostBytes = 256 * 1024;
constexpr int kDeepest = 32;

/// Follows a document without building it.
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
    if (++depth_ > kDeepest)
      refuse(mark, "is nested deeper than " + std::to_string(kDeepest) + " levels; allowed: at most that");
  }
  [[noreturn]] void refuse(const YAML::Mark& mark, const std::string& what) const {
    throw YamlError(yaml_place(source_, mark) + ": " + what);
  }

  const std::string& source_;
  int depth_ = 0;
};

/// yaml-cpp up to 0.6.3 takes all memory for a colon that ends the text within braces; before a new line it
/// finds that these are not closed.
std::string ended(const std::string& yaml) {
  return !yaml.empty() && yaml.back() == ':' ? yaml + '\n' : yaml;
}

}  // namespace

std::string yaml_complaint(const std::string& source, const YAML::Exception& error) {
  return yaml_place(source, error.mark) + ": not YAML: " + text::one_line(error.msg);
}

YAML::Node load_yaml(const std::string& source, const std::string& yaml) {
  return load_yaml(source, yaml, kMostBytes);
}

YAML::Node load_yaml(const std::string& source, const std::string& yaml, std::size_t most) {
  if (yaml.size() > most)
    throw YamlError(source + ": is longer than " + std::to_string(most) + " bytes; allowed: at most that");
  try {
    const std::string whole = ended(yaml);
    std::istringstream text(whole);
    YAML::Parser parser(text);
    Guard guard(source);
    parser.HandleNextDocument(guard);
    return YAML::Load(whole);
  } catch (const YAML::Exception& error) {
    throw YamlError(yaml_complaint(source, error));
  }
}

YAML::Node load_yaml_file(const std::string& file) {
  const std::optional<std::string> text = file_text(file, kMostBytes + 1);
  if (!text) throw YamlError(file + ": cannot be read; allowed: a readable YAML file");
  return load_yaml(file, *text);
}

}  // namespace mrhi
