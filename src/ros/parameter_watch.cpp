#include "parameter_watch.h"

#include "../record/world.h"
#include "mr_hand_interaction/parameters.h"

namespace mrhi {
namespace {

using mr_hand_interaction::SimulationInput;

std::map<std::string, std::string> texts_of(const Configuration& configuration) {
  std::map<std::string, std::string> texts;
  for (const std::string& name : parameter_names()) texts[name] = parameter_text(configuration, name);
  return texts;
}

RecordedFiles files_of(const SimulationInput& message) {
  RecordedFiles files;
  for (const auto& file : message.files) files.push_back({file.name, {file.bytes.begin(), file.bytes.end()}});
  return files;
}

/// As they are once the message has been taken.
Configuration after(const SimulationInput& message, Configuration configuration) {
  if (message.kind == SimulationInput::BEGIN) {
    const auto gravity = configuration.gravity;
    std::vector<std::string> unknown;
    configuration = configuration_of(world_from_yaml(message.text, files_of(message)), unknown);
    configuration.gravity = gravity;
    return configuration;
  }
  const Change change = change_from_yaml(message.text, files_of(message));
  if (const auto* set = std::get_if<SetParameters>(&change)) {
    for (const auto& [name, value] : set->values)
      if (!grasp_parameter(name)) set_parameter(configuration, name, value);
  }
  return configuration;
}

bool may_set(const SimulationInput& message) {
  if (message.kind == SimulationInput::BEGIN) return true;
  return message.kind == SimulationInput::CHANGE && message.text.find("set") != std::string::npos;
}

}  // namespace

ParameterWatch::ParameterWatch(const Configuration& configuration)
    : begun_(texts_of(configuration)), now_(configuration) {}

std::vector<ParameterWatch::Difference> ParameterWatch::take(const SimulationInput& message) {
  if (!may_set(message)) return {};
  const Configuration later = after(message, now_);
  std::vector<Difference> differences;
  const Texts before = texts_of(now_);
  for (const auto& [name, value] : texts_of(later)) {
    if (value != before.at(name)) differences.push_back({name, value, value == begun_.at(name)});
  }
  now_ = later;
  return differences;
}

}  // namespace mrhi
