#include <cstdio>
#include <iostream>

#include "../text/command_line.h"
#include "../text/text.h"
#include "../training/operator_trial.h"
#include "exit_status.h"
#include "mr_hand_interaction/parameters.h"
#include "mr_hand_interaction/response/contact_model.h"
#include "mr_hand_interaction/ros/package_paths.h"
#include "mr_hand_interaction/synthetic/random.h"

namespace {

using namespace mrhi;

const char* const kHelp =
    "usage: simulated_study --output DIR [options]\n\n"
    "Lets simulated operators (no person takes part) do a task. Writes a session folder for each operator,\n"
    "contact model and gravity: DIR/MODEL_Gg/PNN. Resumes the sessions that DIR has, if their task, "
    "parameters,\n"
    "scenes, version and revision are the same.\n\n"
    "  --operators FIRST-LAST   numbers of the operators; default 1-30\n"
    "  --group-size N           the first N operators are beginners, all others veterans; default 15\n"
    "  --model NAME             contact model; repeatable; default: all\n"
    "  --gravity G              in g, from 0 to 10; repeatable; default: 0 and 1\n"
    "  --task NAME|FILE         default: pick_and_place\n"
    "  --set KEY=VALUE          a parameter, as in config/default.yaml; repeatable\n"
    "  --seed N                 a whole number; default 1\n"
    "  --free-hands             afloat, operators work without a hand on a rail\n";

constexpr long kMaxCount = 1000000;           // of integers
constexpr double kStandardGravity = 9.80665;  // [m/s^2]

struct Study {
  std::string output, task = "pick_and_place";
  int first = 1, last = 30, group_size = 15;
  std::vector<std::string> models;
  std::vector<double> gravities;
  std::vector<std::pair<std::string, std::string>> settings;
  std::uint64_t seed = 1;
  bool free_hands = false;
};

void read_operators(const OptionValue& given, Study& study) {
  const std::size_t dash = given.text.find('-');
  const auto part = [&](const std::string& text) {
    return static_cast<int>(OptionValue{given.option, given.form, text}.whole(1, kMaxCount));
  };
  study.first = part(given.text.substr(0, dash));
  study.last = dash == std::string::npos ? study.first : part(given.text.substr(dash + 1));
  if (study.last < study.first) given.refuse("FIRST-LAST, FIRST at most LAST");
}

/// Empty for --help.
std::optional<Study> read_arguments(const std::vector<std::string>& arguments) {
  Study study;
  CommandLine line;
  line.once("--output", "DIR", study.output).once("--task", "NAME|FILE", study.task);
  line.once("--operators", "FIRST-LAST", [&](const OptionValue& given) { read_operators(given, study); });
  line.once("--group-size", "N", [&](const OptionValue& given) {
    study.group_size = static_cast<int>(given.whole(0, kMaxCount));
  });
  line.each("--model", "NAME", [&](const OptionValue& given) { study.models.push_back(given.text); });
  line.each("--gravity", "G",
            [&](const OptionValue& given) { study.gravities.push_back(given.number(0.0, 10.0)); });
  line.each("--set", "KEY=VALUE",
            [&](const OptionValue& given) { study.settings.push_back(given.setting()); });
  line.once("--seed", "N", [&](const OptionValue& given) {
    study.seed = static_cast<std::uint64_t>(given.whole(0, kMaxCount));
  });
  line.flag("--free-hands", study.free_hands);
  if (!line.read(arguments)) return std::nullopt;
  if (study.output.empty()) throw UsageError("--output is missing: --output DIR");
  if (study.models.empty())
    for (const ContactModelEntry* model : contact_models()) study.models.emplace_back(model->name);
  if (study.gravities.empty()) study.gravities = {0.0, 1.0};
  return study;
}

Configuration configuration_of(const Study& study, const std::string& model) {
  Configuration configuration;
  rethrown<UsageError, ParameterError>("", [&] {
    for (const auto& [key, value] : study.settings) set_parameter(configuration, key, value);
    set_parameter(configuration, "contact_model", model);
    validate(configuration);
  });
  return configuration;
}

/// Runs one simulated operator's session under one condition.
void play_session(const Study& study, int person, const std::string& model, double gravity, Task task) {
  const std::string name = text::format("P%02d", person), strength = text::format("%gg", gravity);
  task.gravity = Vector3(0.0, 0.0, -kStandardGravity * gravity);

  OperatorStage stage;
  stage.configuration = configuration_of(study, model);
  stage.scene_folders = scene_folders();
  stage.scene_options = scene_options(stage.configuration);

  // The same person, hand and noise under every condition.
  Random seeds(study.seed * 1000003u + static_cast<std::uint64_t>(person));
  SessionHeader header;
  header.participant = name;
  header.group = person <= study.group_size ? "beginner" : "veteran";
  header.handedness = "right";
  header.condition = study.free_hands ? model + "_free_hands" : model;
  header.seed = study.seed;
  header.simulated = true;
  header.software = MR_HAND_INTERACTION_VERSION;
  OperatorSkill skill = draw_skill(header.group, seeds.bits());
  skill.holds_rail = !study.free_hands;
  const std::uint64_t trials = seeds.bits();
  const std::string folder = study.output + "/" + header.condition + "_" + strength + "/" + name;
  const SessionSetup setup = session_setup(study.task, task, stage.configuration, stage.scene_folders,
                                           stage.scene_options, MR_HAND_INTERACTION_VERSION);
  Session session(task, header, static_cast<std::uint64_t>(person - 1), folder, 0, setup);
  Nanoseconds stamp = 0;
  while (session.phase() == SessionPhase::ready) {
    stamp = play_trial(session, skill, trials + session.position(), stage, stamp) + 1'000'000'000;
    const TrialRow& row = *session.last();
    std::printf("%s %s %s %s: %s, %.1f s, attempts %d, drops %d\n", name.c_str(), model.c_str(),
                strength.c_str(), row.object.c_str(), to_string(row.result), row.measures.completion_time,
                row.measures.attempts, row.measures.drops);
    std::fflush(stdout);
  }
}

void play(Study study) {
  study.task = find_task_file(study.task, task_folders());
  for (const std::string& model : study.models) configuration_of(study, model);  // checked first
  const Task task = load_task(study.task);
  OperatorStage stage;
  stage.scene_folders = scene_folders();
  check_operator(task, stage);
  for (int person = study.first; person <= study.last; ++person) {
    for (const std::string& model : study.models) {
      for (const double gravity : study.gravities) play_session(study, person, model, gravity, task);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  return mrhi::exit_status("simulated_study", [&] {
    const std::optional<Study> study = read_arguments({argv + 1, argv + argc});
    study ? play(*study) : void(std::cout << kHelp);
    return 0;
  });
}
