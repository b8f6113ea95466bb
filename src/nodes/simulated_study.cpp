#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <sstream>

#include "mr_hand_interaction/parameters.h"
#include "mr_hand_interaction/replay/arguments.h"
#include "mr_hand_interaction/response/contact_model.h"
#include "mr_hand_interaction/ros/package_paths.h"
#include "mr_hand_interaction/synthetic/random.h"
#include "mr_hand_interaction/training/operator_trial.h"

namespace {

using namespace mrhi;

const char* const kHelp =
    "usage: simulated_study --output DIR [options]\n\n"
    "Lets simulated operators (no person takes part) do a task, and writes a session's folder for each of\n"
    "them, contact model and gravity: DIR/MODEL_Gg/PNN. Sessions that are there are gone on with, if their "
    "task,\n"
    "parameters, scenes, version and revision are the same.\n\n"
    "  --operators FIRST-LAST   of those with these numbers; default 1-30\n"
    "  --group-size N           the first N operators are beginners, all others veterans; default 15\n"
    "  --model NAME             contact model; again for more; default: all\n"
    "  --gravity G              in g, from 0 to 10; again for more; default: 0 and 1\n"
    "  --task NAME|FILE         default: pick_and_place\n"
    "  --set KEY=VALUE          a parameter, as in config/default.yaml; again for more\n"
    "  --seed N                 a whole number; default 1\n";

constexpr double kStandardGravity = 9.80665;  // [m/s^2]

struct Study {
  std::string output, task = "pick_and_place";
  int first = 1, last = 30, group_size = 15;
  std::vector<std::string> models;
  std::vector<double> gravities;
  std::vector<std::pair<std::string, std::string>> settings;
  std::uint64_t seed = 1;
  bool help = false;
};

double number(const std::string& option, const std::string& text, double lowest, double highest) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !(value >= lowest && value <= highest)) {
    std::ostringstream what;
    what << option << " '" << text << "' is not allowed; allowed: a number from " << lowest << " to "
         << highest;
    throw UsageError(what.str());
  }
  return value;
}

int whole(const std::string& option, const std::string& text, int lowest) {
  const double value = number(option, text, lowest, 1e6);
  if (value != std::floor(value))
    throw UsageError(option + " '" + text + "' is not allowed; allowed: a whole number");
  return static_cast<int>(value);
}

void read_operators(const std::string& text, Study& study) {
  const std::size_t dash = text.find('-');
  study.first = whole("--operators", text.substr(0, dash), 1);
  study.last = dash == std::string::npos ? study.first : whole("--operators", text.substr(dash + 1), 1);
  if (study.last < study.first)
    throw UsageError("--operators '" + text + "' is not allowed; allowed: FIRST-LAST, FIRST at most LAST");
}

void read_option(const std::string& option, const std::string& value, Study& study) {
  if (option == "--output") {
    study.output = value;
  } else if (option == "--operators") {
    read_operators(value, study);
  } else if (option == "--group-size") {
    study.group_size = whole(option, value, 0);
  } else if (option == "--model") {
    study.models.push_back(value);
  } else if (option == "--gravity") {
    study.gravities.push_back(number(option, value, 0.0, 10.0));
  } else if (option == "--task") {
    study.task = value;
  } else if (option == "--seed") {
    study.seed = static_cast<std::uint64_t>(whole(option, value, 0));
  } else if (option == "--set") {
    const std::size_t equals = value.find('=');
    if (equals == std::string::npos || equals == 0)
      throw UsageError("--set '" + value + "' is not allowed; allowed: KEY=VALUE");
    study.settings.emplace_back(value.substr(0, equals), value.substr(equals + 1));
  } else {
    throw UsageError("option '" + option + "' is not known; see --help");
  }
}

Study read_arguments(const std::vector<std::string>& arguments) {
  Study study;
  for (std::size_t i = 0; i < arguments.size(); i += 2) {
    if (arguments[i] == "--help" || arguments[i] == "-h") {
      study.help = true;
      return study;
    }
    if (i + 1 == arguments.size()) throw UsageError(arguments[i] + ": no value; see --help");
    read_option(arguments[i], arguments[i + 1], study);
  }
  if (study.output.empty()) throw UsageError("--output is missing: --output DIR");
  if (study.models.empty())
    for (const ContactModelEntry* model : contact_models()) study.models.emplace_back(model->name);
  if (study.gravities.empty()) study.gravities = {0.0, 1.0};
  return study;
}

Configuration configuration_of(const Study& study, const std::string& model) {
  Configuration configuration;
  try {
    for (const auto& [key, value] : study.settings) set_parameter(configuration, key, value);
    set_parameter(configuration, "contact_model", model);
    validate(configuration);
  } catch (const ParameterError& error) {
    throw UsageError(error.what());
  }
  return configuration;
}

/// What one simulated operator did under one condition.
void play_session(const Study& study, int person, const std::string& model, double gravity, Task task) {
  char name[16], strength[16];
  std::snprintf(name, sizeof name, "P%02d", person);
  std::snprintf(strength, sizeof strength, "%gg", gravity);
  task.gravity = Vector3(0.0, 0.0, -kStandardGravity * gravity);

  OperatorStage stage;
  stage.configuration = configuration_of(study, model);
  stage.scene_folders = scene_folders();
  stage.scene_options = scene_options(stage.configuration);

  // The same person, with the same hand and noise, under every condition.
  Random seeds(study.seed * 1000003u + static_cast<std::uint64_t>(person));
  SessionHeader header;
  header.participant = name;
  header.group = person <= study.group_size ? "beginner" : "veteran";
  header.handedness = "right";
  header.condition = model;
  header.seed = study.seed;
  header.simulated = true;
  header.software = MR_HAND_INTERACTION_VERSION;
  const OperatorSkill skill = draw_skill(header.group, seeds.bits());
  const std::uint64_t trials = seeds.bits();
  const std::string folder = study.output + "/" + model + "_" + strength + "/" + name;
  const SessionSetup setup = session_setup(study.task, task, stage.configuration, stage.scene_folders,
                                           stage.scene_options, MR_HAND_INTERACTION_VERSION);
  Session session(task, header, static_cast<std::uint64_t>(person - 1), folder, 0, setup);
  Nanoseconds stamp = 0;
  while (session.phase() == SessionPhase::ready) {
    stamp = play_trial(session, skill, trials + session.position(), stage, stamp) + 1'000'000'000;
    const TrialRow& row = *session.last();
    std::printf("%s %s %s %s: %s, %.1f s, attempts %d, drops %d\n", name, model.c_str(), strength,
                row.object.c_str(), to_string(row.result), row.measures.completion_time,
                row.measures.attempts, row.measures.drops);
    std::fflush(stdout);
  }
}

void play(Study study) {
  study.task = find_task_file(study.task, task_folders());
  for (const std::string& model : study.models) configuration_of(study, model);  // before anything is played
  const Task task = load_task(study.task);
  for (int person = study.first; person <= study.last; ++person) {
    for (const std::string& model : study.models) {
      for (const double gravity : study.gravities) play_session(study, person, model, gravity, task);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const Study study = read_arguments({argv + 1, argv + argc});
    if (study.help) {
      std::cout << kHelp;
    } else {
      play(study);
    }
  } catch (const mrhi::UsageError& error) {
    std::cerr << "simulated_study: " << error.what() << std::endl;
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "simulated_study: " << error.what() << std::endl;
    return 1;
  }
  return 0;
}
