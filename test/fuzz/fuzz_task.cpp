// A training task, and the folder of a session that is gone on with: session.yaml, trials.csv, events.csv,
// setup/parameters.yaml.
#include "fuzz/target.h"
#include "mr_hand_interaction/scene/scene_loader.h"
#include "mr_hand_interaction/training/session.h"

namespace {

using namespace mrhi;

/// What the session that goes on is played with, if there is a setup at all.
const SessionSetup kSetup{{{"parameters.yaml", "contact_model: implicit\nstep: 0.001\n"}}};

void fill(const std::string& session, const std::vector<std::string>& parts) {
  static const char* const names[] = {"session.yaml", "trials.csv", "events.csv", "setup/parameters.yaml"};
  fuzzing::folder().remove("session");
  std::filesystem::create_directories(session + "/setup");
  for (std::size_t i = 0; i < 4; ++i)
    if (!parts[i + 1].empty()) fuzzing::folder().write(std::string("session/") + names[i], parts[i + 1]);
}

/// Two trials: one aborted, one passed over.
void go_on(const Task& task, const std::string& folder, const SessionSetup& setup) {
  SessionHeader header;
  header.participant = "P01";
  header.group = "beginner";
  header.handedness = "right";
  header.condition = "hands";
  Session session(task, header, 0, folder, 0, setup);
  session.begin(1'000'000'000);
  session.abort(2'000'000'000);
  session.skip(3'000'000'000);
  fuzzing::require(session.position() <= session.trials(), "the trial is one of the plan");
}

}  // namespace

FUZZ_TARGET(task) {
  const std::vector<std::string> parts = fuzzing::parts_of(data, size, 5);
  try {
    const Task task = load_task(fuzzing::folder().write("task.yaml", parts[0]));
    for (std::size_t goal = 0; goal < task.goals.size(); ++goal) instruction(task, goal, "thing");
    const std::string session = fuzzing::folder().file("session");
    fill(session, parts);
    go_on(task, session, parts[4].empty() ? SessionSetup() : kSetup);
  } catch (const SceneError& error) {
    fuzzing::require_one_line(error.what());
  } catch (const SessionError& error) {
    fuzzing::require_one_line(error.what());
  }
}
