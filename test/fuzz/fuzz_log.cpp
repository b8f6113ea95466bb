// What a recording of a live run says of its world, and a change: the world's YAML, its URDF, the YAML beside
// that, the change's YAML, a URDF that it may name. What is taken is simulated.
#include "fuzz/target.h"
#include "mr_hand_interaction/ros/package_paths.h"
#include "record/record.h"
#include "support/fixtures.h"

namespace {

using namespace mrhi;

void advance(LiveSimulation& simulation, int from) {
  for (int i = from; i < from + 4; ++i) {
    const Vector3 tip(0.01 * i, 0.0, 0.0);
    simulation.simulation().advance(
        {mrhi::testing::at(0.005 * i), {mrhi::testing::finger(tip, tip + Vector3(0, 0.03, 0), 0.008)}});
    fuzzing::require(simulation.simulation().result().not_finite.empty(), "what comes out is finite");
  }
}

void change(const std::string& yaml, const RecordedFiles& files, LiveSimulation& simulation) {
  Change change = change_from_yaml(yaml, files);
  fuzzing::require(!to_text(change).empty(), "a change can be told");
  fuzzing::require(to_yaml(change_from_yaml(to_yaml(change), files)) == to_yaml(change),
                   "a change is the same again after it has been read");
  prepare(change, scene_options(simulation.simulation().configuration()));
  apply_change(change, simulation);
}

void replay(const std::vector<std::string>& parts) {
  const RecordedFiles files{{"scene.urdf", parts[1]}, {"scene.yaml", parts[2]}, {"spawn/box.urdf", parts[4]}};
  const World world = world_from_yaml(parts[0], files);
  std::vector<std::string> unknown;
  const Configuration configuration = configuration_of(world, unknown);
  for (const std::string& what : unknown) fuzzing::require_one_line(what);
  static const std::string kAll = fuzzing::folder().file("log"), kScenes = kAll + "/scenes";
  fuzzing::folder().remove("log");
  std::filesystem::create_directories(kScenes);
  LiveSimulation simulation(scene_of(world, scene_options(configuration), kScenes), configuration);
  for (const auto& entry : std::filesystem::directory_iterator(kAll))
    fuzzing::require(entry.path().filename() == "scenes", "nothing is written elsewhere");
  advance(simulation, 0);
  change(parts[3], files, simulation);
  advance(simulation, 4);
}

}  // namespace

FUZZ_TARGET(log) {
  try {
    replay(fuzzing::parts_of(data, size, 5));
  } catch (const std::exception& error) {
    fuzzing::require_one_line(error.what());
  }
}
