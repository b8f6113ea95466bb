#include "command_line.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "text.h"

namespace mrhi {

void OptionValue::refuse(const std::string& allowed) const {
  throw UsageError(option + " '" + text + "' is not allowed; allowed: " + allowed);
}

void OptionValue::fail(const std::string& what) const {
  throw UsageError(option + " " + text + ": " + what + "; allowed: " + option + " " + form);
}

double OptionValue::number(double lowest, double highest) const {
  const auto value = text::to_number(text);
  if (!value || !(*value >= lowest && *value <= highest))
    refuse("a number from " + text::number(lowest) + " to " + text::number(highest));
  return *value;
}

long OptionValue::whole(long lowest, long highest) const {
  const auto value = text::to_number(text);
  if (!value || !(*value >= static_cast<double>(lowest) && *value <= static_cast<double>(highest)) ||
      *value != std::floor(*value))
    refuse("a whole number from " + std::to_string(lowest) + " to " + std::to_string(highest));
  return static_cast<long>(*value);
}

const std::string& OptionValue::one_of(const std::vector<std::string>& names) const {
  if (std::find(names.begin(), names.end(), text) == names.end()) refuse(text::joined(names));
  return text;
}

std::pair<std::string, std::string> OptionValue::setting() const {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) refuse("KEY=VALUE");
  return {text.substr(0, equals), text.substr(equals + 1)};
}

std::vector<double> OptionValue::numbers(std::size_t first, std::size_t count) const {
  const std::vector<std::string> fields = text::split(text);
  if (fields.size() != first + count)
    fail(std::to_string(fields.size()) + " fields instead of " + std::to_string(first + count));
  std::vector<double> values;
  for (std::size_t i = first; i < fields.size(); ++i) {
    const auto value = text::to_number(fields[i]);
    if (!value || !std::isfinite(*value)) fail("'" + fields[i] + "' is no finite number");
    values.push_back(*value);
  }
  return values;
}

CommandLine& CommandLine::flag(const std::string& name, bool& on) {
  options_.push_back({name, "", true, [&on](const OptionValue&) { on = true; }});
  return *this;
}

CommandLine& CommandLine::once(const std::string& name, const std::string& form, const Take& take) {
  options_.push_back({name, form, false, take});
  return *this;
}

CommandLine& CommandLine::once(const std::string& name, const std::string& form, std::string& text) {
  return once(name, form, [&text](const OptionValue& given) { text = given.text; });
}

CommandLine& CommandLine::each(const std::string& name, const std::string& form, const Take& take) {
  options_.push_back({name, form, true, take});
  return *this;
}

CommandLine& CommandLine::words(const Take& take) {
  words_ = take;
  return *this;
}

bool CommandLine::read(const std::vector<std::string>& words) const {
  std::set<std::string> seen;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    if (word == "--help" || word == "-h") return false;
    const Option* const option = find(word);
    if (option == nullptr) {
      if (!words_ || word.compare(0, 2, "--") == 0)
        throw UsageError("unknown argument '" + word + "'; allowed: " + names());
      words_({"", "", word});
      continue;
    }
    if (!seen.insert(word).second && !option->repeats)
      throw UsageError(word + " is given twice; allowed: once");
    if (option->form.empty()) {
      option->take({word, "", ""});
      continue;
    }
    if (i + 1 == words.size() || words[i + 1].empty() || find(words[i + 1]) != nullptr)
      throw UsageError(word + " needs a value: " + word + " " + option->form);
    option->take({word, option->form, words[++i]});
  }
  return true;
}

const CommandLine::Option* CommandLine::find(const std::string& name) const {
  return text::find_named(options_, name);
}

std::string CommandLine::names() const {
  std::vector<std::string> names{"--help"};
  for (const Option& option : options_) names.push_back(option.name);
  return text::joined(names);
}

}  // namespace mrhi
