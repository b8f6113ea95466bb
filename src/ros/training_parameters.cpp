#include "training_server.h"

#include <cstdlib>
#include <functional>
#include <limits>
#include <locale>
#include <map>
#include <sstream>
#include <type_traits>

#include "mr_hand_interaction/parameters.h"
#include "mr_hand_interaction/ros/server_parameters.h"

namespace mrhi {
namespace {

[[noreturn]] void refuse(const std::string& name, const std::string& value, const std::string& allowed) {
  throw ParameterError("parameter '" + name + "': '" + value + "' is not allowed; allowed: " + allowed);
}

constexpr int kMost = std::numeric_limits<int>::max();
constexpr double kLongestBreak = 3600.0;  // [s]

template <class Number>
Number number(const std::string& name, const std::string& text, Number lowest, Number highest,
              const char* more = "") {
  std::istringstream in(text);
  in.imbue(std::locale::classic());
  Number value{};
  if (!(in >> value) || in.peek() != std::istringstream::traits_type::eof() ||
      !(value >= lowest && value <= highest)) {
    std::ostringstream allowed;
    allowed.imbue(std::locale::classic());
    allowed << (std::is_integral<Number>::value ? "a whole number" : "a number") << " from " << lowest
            << " to " << highest << more;
    refuse(name, text, allowed.str());
  }
  return value;
}

bool truth(const std::string& name, const std::string& text) {
  if (text != "true" && text != "false") refuse(name, text, "true, false");
  return text == "true";
}

std::string with_home(const std::string& folder) {
  const char* const home = std::getenv("HOME");
  if (home == nullptr || folder.compare(0, 2, "~/") != 0) return folder;
  return home + folder.substr(1);
}

using Setter = std::function<void(const std::string& name, const std::string& text, TrainingParameters&)>;

const std::map<std::string, Setter>& setters() {
  using Text = const std::string&;
  using P = TrainingParameters&;
  static const std::map<std::string, Setter> all{
      {"task", [](Text, Text text, P p) { p.task = text; }},
      {"participant", [](Text, Text text, P p) { p.header.participant = text; }},
      {"group", [](Text, Text text, P p) { p.header.group = text; }},
      {"handedness", [](Text, Text text, P p) { p.header.handedness = text; }},
      {"condition", [](Text, Text text, P p) { p.header.condition = text; }},
      {"seed", [](Text name, Text text,
                  P p) { p.header.seed = static_cast<std::uint64_t>(number<int>(name, text, 0, kMost)); }},
      {"session", [](Text name, Text text, P p) { p.header.session = number<int>(name, text, 1, kMost); }},
      {"simulated", [](Text name, Text text, P p) { p.header.simulated = truth(name, text); }},
      {"number", [](Text name, Text text, P p) { p.number = number<int>(name, text, 1, kMost); }},
      {"folder", [](Text, Text text, P p) { p.folder = with_home(text); }},
      {"simulation", [](Text, Text text, P p) { p.simulation = text; }},
      {"auto_next",
       [](Text name, Text text, P p) {
         p.auto_next =
             number<double>(name, text, -kLongestBreak, kLongestBreak, " [s], below 0: not by itself");
       }},
      {"operator", [](Text name, Text text, P p) { p.by_operator = truth(name, text); }},
      {"auto_start", [](Text name, Text text, P p) { p.auto_start = truth(name, text); }},
  };
  return all;
}

}  // namespace

TrainingParameters read_training_parameters(const ros::NodeHandle& private_node) {
  TrainingParameters parameters;
  XmlRpc::XmlRpcValue values;
  const bool any = private_node.getParam(private_node.getNamespace(), values) &&
                   values.getType() == XmlRpc::XmlRpcValue::TypeStruct;
  for (auto value = values.begin(); any && value != values.end(); ++value) {
    const auto setter = setters().find(value->first);
    if (setter == setters().end()) {
      std::string allowed;
      for (const auto& known : setters()) allowed += (allowed.empty() ? "" : ", ") + known.first;
      throw ParameterError("unknown parameter '" + value->first + "'; allowed: " + allowed);
    }
    setter->second(value->first, yaml_text(value->second), parameters);
  }
  if (parameters.header.participant.empty()) refuse("participant", "", "who takes part, such as P07");
  if (parameters.folder.empty()) refuse("folder", "", "where the session is to be");
  return parameters;
}

}  // namespace mrhi
