#include <gtest/gtest.h>

#include <random>

#include "mr_hand_interaction/replay/replay.h"
#include "mr_hand_interaction/response/contact_model.h"
#include "mr_hand_interaction/scene/save_scene.h"
#include "mr_hand_interaction/scene/scene_loader.h"
#include "mr_hand_interaction/simulation_state.h"
#include "mr_hand_interaction/synthetic/synthetic_hand.h"
#include "operators/operators_at_work.h"
#include "parts.h"
#include "replay/replay_files.h"
#include "support/fixtures.h"
#include "support/reviewed_bits.h"

namespace mrhi {
namespace {

/// A scripted motion with a Leap's noise at a tracker's rate, in a scene that is shipped.
struct NoisyReplay {
  std::string motion, scene, model, gravity;
  int rate;           // [1/s]
  bool both = false;  // a left hand does the same, mirrored
  std::string parameter = "", value = "";

  std::string name() const {
    return motion + "," + scene + (parameter.empty() ? "" : " " + parameter + " " + value) + "," + model +
           "," + gravity + "," + std::to_string(rate) + "," + (both ? "2" : "1");
  }
};

/// Values that differ from the defaults.
const std::pair<const char*, const char*> kParameters[] = {
    {"filter/type", "none"},
    {"filter/type", "window"},
    {"filter/type", "one_euro"},
    {"filter/noise", "0.001"},
    {"contact/anchors", "false"},
    {"contact/damping", "false"},
    {"contact/grasp_assist", "false"},
    {"contact/impact_friction", "false"},
    {"contact/release_fade", "false"},
    {"contact/sleep", "false"},
    {"contact/swing_back", "false"},
    {"contact/torsion", "false"},
    {"hand/strength", "unlimited"},
    {"hand/pad", "0"},
    {"hand/restitution", "0.5"},
    {"hand/joint_speed", "3"},
    {"rendering/control_display_ratio", "1.5"},
    {"material/restitution", "0.9"},
};

std::vector<NoisyReplay> runs() {
  std::vector<NoisyReplay> all;
  for (const std::string& motion : motion_names()) {
    for (const char* gravity : {"0", "-9.81"})
      all.push_back({motion, make_motion(motion).scene, "implicit", gravity, 90});
  }
  for (const ContactModelEntry* model : contact_models()) {
    if (model->name == std::string("implicit")) continue;
    for (const char* motion : {"grasp_cube", "slap", "turn_valve"})
      all.push_back({motion, make_motion(motion).scene, model->name, "0", 90});
  }
  for (const char* scene : {"mixed", "cube_on_table", "rack"})
    all.push_back({"grasp_cube", scene, "implicit", "0", 60});
  for (const int rate : {30, 60, 120}) all.push_back({"grasp_cube", "cube", "implicit", "0", rate});
  for (const char* motion : {"grasp_cube", "grasp_ball", "nudge"})
    all.push_back({motion, make_motion(motion).scene, "implicit", "0", 120, true});
  for (const auto& [parameter, value] : kParameters)
    all.push_back({"grasp_cube", "cube_on_table", "implicit", "-9.81", 90, false, parameter, value});
  for (const char* parameter : {"contact/edge_grip", "contact/two_points"})
    all.push_back({"lift_flat", "flat_cuboid", "implicit", "-9.81", 90, false, parameter, "false"});
  all.push_back({"slap", "cube", "implicit", "0", 30, false, "contact/sweep", "false"});
  for (const char* motion : {"grasp_cube", "slap", "catch_ball", "nudge"})
    all.push_back({motion, make_motion(motion).scene, "seed", "0", 90, false, "seed/literal", "true"});
  for (const char* scene : {"bag", "crate", "docking", "handrails", "hatch"})
    all.push_back({"grasp_cube", scene, "implicit", "0", 90});
  return all;
}

std::string bits_of(const NoisyReplay& run) {
  const test::Folder folder;
  std::vector<JointsFrame> frames = test::motion_frames(run.motion, run.rate, 0);
  const ScriptedMotion motion = make_motion(run.motion);
  for (JointsFrame& frame : frames) {
    if (!run.both) break;
    for (HandJoints hand : sample(motion, Side::left, frame.stamp, default_device_mount()).hands) {
      hand.id += 1000;
      frame.hands.push_back(hand);
    }
  }
  TrackingNoise noise(1.0, 1);
  for (JointsFrame& frame : frames) noise.apply(frame);
  ReplayArguments arguments;
  arguments.scene = "config/scenes/" + run.scene + ".urdf";
  arguments.input = test::write_recording(folder / "recording.csv", frames);
  arguments.output = folder / "out";
  arguments.settings = {{"contact_model", run.model}, {"gravity", "[0, 0, " + run.gravity + "]"}};
  if (!run.parameter.empty()) arguments.settings.emplace_back(run.parameter, run.value);
  replay(arguments);
  std::uint64_t state = 0;
  for (const std::string& line : test::lines_of(folder / "out/summary.json")) {
    const auto at = line.find("\"state_hash\": \"");
    if (at != std::string::npos) state = std::strtoull(line.c_str() + at + 15, nullptr, 16);
  }
  std::string tables;
  for (const char* table : {"objects", "contacts", "hands", "events", "joints"})
    tables += test::text_of(folder / (std::string("out/") + table + ".csv"));
  return test::hexadecimal(state) + "," + test::hexadecimal(std::hash<std::string>()(tables));
}

/// Bodies of every kind of shape, thrown at each other over a table: each kind meets each. Many become one
/// large island.
struct Pile {
  double gravity, restitution;
  int rate;  // of steps [1/s]
  int bodies = 18;

  std::string name() const {
    return (bodies == 18 ? "pile,restitution " : "pile of " + std::to_string(bodies) + ",restitution ") +
           std::to_string(restitution).substr(0, 3) + ",implicit," + (gravity == 0.0 ? "0" : "-9.81") + "," +
           std::to_string(rate) + ",1";
  }
};
constexpr Pile kPiles[] = {{-9.81, 0.3, 1000}, {-9.81, 0.3, 120},      {0.0, 1.0, 1000},
                           {0.0, 0.5, 60},     {-9.81, 0.0, 1000, 54}, {-9.81, 0.3, 120, 54}};

std::vector<PlacedShape> shapes_of_kind(std::size_t kind) {
  if (kind < 5) return {{shape_of_kind(kind), {}}};
  return {{Box{Vector3(0.03, 0.01, 0.01)}, {}},
          {Cylinder{0.01, 0.02}, {{0.02, 0.0, 0.02}, Quaternion::Identity()}}};
}

Scene scene_of(const Pile& pile) {
  Body table = testing::box_body(Vector3(1.0, 1.0, 0.1), 1.0);
  table.name = "table";
  table.fixed = true;
  table.start.position.z() = 0.05;
  Scene scene = testing::scene_of(table);
  scene.gravity = Vector3(0, 0, pile.gravity);
  std::mt19937 random(7);
  const auto next = [&random] { return 2.0 * random() / 4294967296.0 - 1.0; };
  for (int i = 0; i < pile.bodies; ++i) {
    Body body;
    body.name = "body" + std::to_string(i);
    body.mass = 0.02 + 0.01 * (i % 4);
    body.inertia = body.mass * 0.0003 * Vector3(0.6, 0.8, 1.0).asDiagonal();
    body.material.restitution = pile.restitution;
    body.shapes = shapes_of_kind(static_cast<std::size_t>(i % 6));
    body.start.position = Vector3(0.1 * (i % 3 - 1), 0.05 + 0.1 * (i / 3 % 3 - 1), 0.2 + 0.1 * (i / 9));
    body.start.orientation = Quaternion(1.0 + next(), next(), next(), next()).normalized();
    body.start_twist.linear = 3.0 * (Vector3(0, 0.05, 0.25) - body.start.position);
    body.start_twist.angular = 4.0 * Vector3(next(), next(), next());
    complete(body);
    scene.bodies.push_back(body);
  }
  for (Body& body : scene.bodies) body.material.restitution = pile.restitution;
  return scene;
}

/// A finger passes through them meanwhile.
std::string bits_of(const Pile& pile) {
  Configuration configuration = testing::unfiltered(ContactModelKind::implicit);
  configuration.step = 1.001 / pile.rate;
  Simulation simulation(scene_of(pile), configuration);
  std::uint64_t all = 0;
  for (int i = 0; i <= 3 * pile.rate / 2; ++i) {
    const double t = static_cast<double>(i) / pile.rate;
    const Vector3 tip(0.3 * t - 0.2, 0.05, 0.16);
    simulation.advance({testing::at(t), {testing::finger(tip + Vector3(0, 0, 0.05), tip, 0.01)}});
    all = 31 * all + hash(simulation.state());
  }
  return test::hexadecimal(hash(simulation.state())) + "," + test::hexadecimal(all);
}

/// A trial of a simulated operator.
struct PlayedTrial {
  std::string task;
  std::uint64_t seed;
  double noise;
  const char* group = "veteran";

  std::string name() const {
    return task + "," + (group == std::string("veteran") ? "operator " : "beginner ") + std::to_string(seed) +
           ",implicit,0," + std::to_string(noise).substr(0, 3) + ",2";
  }
};

std::vector<PlayedTrial> played_trials() {
  std::vector<PlayedTrial> all{{"cube", 5, 1.0}, {"rail", 1, 0.0}, {"throw", 2, 1.0}};
  for (const char* task :
       {"long_cuboid", "catch", "dock", "hatch", "hatch_0g", "nudge_into_box", "slap", "tap"}) {
    all.push_back({task, 3, 1.0});
    all.push_back({task, 4, 1.0, "beginner"});
  }
  for (const char* afloat : {"rail", "throw", "dock", "hatch_0g"})
    for (const std::uint64_t seed : {6, 7}) all.push_back({afloat, seed, 1.0});
  return all;
}

std::string bits_of(const PlayedTrial& trial) {
  const std::string file = "config/tasks/" + trial.task + ".yaml";
  const Task task = std::filesystem::exists(file) ? load_task(file) : testing::task_with(trial.task);
  const TrialMeasures measures =
      testing::play(task, draw_skill(trial.group, trial.seed), trial.seed, trial.noise).measures;
  Digest time, others;
  time.add(measures.completion_time);
  for (const int count : {measures.attempts, measures.drops, measures.touches}) others.add(count);
  for (const std::optional<double>& stage : measures.stage_times) others.add(stage.value_or(-1.0));
  others.add(measures.path_length);
  for (const std::optional<double>& measure :
       {measures.grip_force_mean, measures.grip_force_max, measures.release_drift, measures.release_speed,
        measures.arrival_speed, measures.misplacement, measures.misalignment, measures.operator_speed,
        measures.operator_spin})
    others.add(measure.value_or(-1.0));
  return time.text() + "," + others.text();
}

/// A scene as it is loaded, saved and loaded again.
struct LoadedScene {
  std::string file;
  std::string name() const { return "loaded," + file + ",implicit,0,0,0"; }
};

std::vector<LoadedScene> loaded_scenes() {
  std::vector<LoadedScene> scenes{{"test/regression/scenes/of_all_kinds.urdf"}};
  for (const char* name : {"handrails", "hatch", "panel", "tongs"})
    scenes.push_back({std::string("config/scenes/") + name + ".urdf"});
  return scenes;
}

std::string bits_of(const LoadedScene& loaded) {
  const test::Folder folder;
  SceneOptions options;
  options.resolve_package_uri = [](const std::string& uri) { return uri.substr(uri.find('/', 10) + 1); };
  std::string urdf = loaded.file, texts[2];
  for (const int round : {0, 1}) {
    const std::string saved = folder / ("saved" + std::to_string(round) + ".urdf");
    save_scene(load_scene(urdf, options), saved);
    std::vector<std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "")) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (const std::string& file : files) texts[round] += test::text_of(file);
    urdf = saved;
  }
  const std::hash<std::string> hash;
  return test::hexadecimal(hash(texts[0])) + "," + test::hexadecimal(hash(texts[1]));
}

TEST(Bits, are_those_that_were_reviewed) {
  test::ReviewedBits bits("test/regression/bits.csv", "motion,scene,model,gravity,rate,hands,state,tables");
  if (!bits.made_elsewhere().empty()) GTEST_SKIP() << bits.made_elsewhere();
  const auto compare = [&](const auto& run) { bits.compare(run.name(), bits_of(run)); };
  for (const NoisyReplay& run : runs()) compare(run);
  for (const Pile& pile : kPiles) compare(pile);
  for (const PlayedTrial& trial : played_trials()) compare(trial);
  for (const LoadedScene& scene : loaded_scenes()) compare(scene);
  for (std::size_t kind = 0; kind < kKinds; ++kind) compare(Touching{kind});
  for (const RandomScene& run : kRandomScenes) compare(run);
  for (std::size_t kind = 0; kind < kKinds; ++kind)
    for (const double scale : {1.0, 1.8}) compare(Grasping{kind, scale});
  bits.check("regression");
}

}  // namespace
}  // namespace mrhi
