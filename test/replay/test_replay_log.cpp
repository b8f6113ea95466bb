#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cstring>
#include <filesystem>
#include <functional>

#include "mr_hand_interaction/parameters.h"
#include "mr_hand_interaction/ros/package_paths.h"
#include "record/record.h"
#include "replay/replay_files.h"
#include "replay/run.h"
#include "scene/scene_files.h"
#include "simulation/state_bytes.h"
#include "text/files.h"
#include "text/text.h"

namespace mrhi {
namespace {

constexpr double kRate = 100.0;

class Entries : public LogSource {
 public:
  explicit Entries(std::vector<LogEntry> entries) : entries_(std::move(entries)) { size_ = entries_.size(); }
  std::optional<LogEntry> next() override {
    if (position_ == entries_.size()) return std::nullopt;
    return entries_[position_++];
  }

 private:
  std::vector<LogEntry> entries_;
};

/// A live simulation, and what a recorder beside it gets.
class Live {
 public:
  Live(const std::string& urdf, const Configuration& configuration)
      : live_(load_scene(urdf, scene_options(configuration)), configuration),
        world_(world_of_file(urdf, live_.simulation().scene(), configuration)) {}

  void begin_recording() {
    if (!recorded_) entries.clear();
    recorded_ = true;
    LogEntry& entry = add(LogEntry::Kind::begin);
    entry.text = to_yaml(world_);
    entry.files = world_.files;
    entry.state = to_bytes(live_.simulation().state());
  }

  /// The frames of a motion from one time to another.
  void play(const std::vector<JointsFrame>& frames, double from, double to) {
    for (const JointsFrame& joints : frames) {
      const double time = to_seconds(joints.stamp - frames.front().stamp);
      if (time < from || time >= to) continue;
      std::vector<std::string> defects;
      HandFrame hands = complete_frame(joints, default_device_mount(), defects).value();
      hands.stamp = joints.stamp + 1'000'000'000;
      if (live_.simulation().begin(hands, hands.stamp) != Rejection::none)
        throw std::runtime_error("frame refused");
      while (live_.simulation().step()) {
      }
      live_.simulation().end();
      ++sequence_;
      LogEntry& entry = add(LogEntry::Kind::frame);
      entry.hands = hands;
      entry.expected = hands.stamp;
    }
  }

  void without_hands(double seconds) {
    const Nanoseconds until = live_.simulation().state().last_frame + static_cast<Nanoseconds>(1e9 * seconds);
    if (!live_.simulation().advance_without_hands(until)) throw std::runtime_error("hands again");
    ++sequence_;
    add(LogEntry::Kind::without_hands).time = until;
  }

  void change(Change change) {
    prepare(change, scene_options(live_.simulation().configuration()));
    apply_change(change, live_);
    note(change, live_, world_);
    ++sequence_;
    LogEntry& entry = add(LogEntry::Kind::change);
    entry.text = to_yaml(change);
    entry.files = files_of(change);
  }

  std::vector<LogEntry> entries;

 private:
  LogEntry& add(LogEntry::Kind kind) {
    LogEntry entry;
    entry.kind = kind;
    entry.run = 7;
    entry.sequence = sequence_;
    entry.stamp = live_.simulation().state().time;
    entry.state_hash = hash(live_.simulation().state());
    entries.push_back(entry);
    return entries.back();
  }

  LiveSimulation live_;
  World world_;
  std::uint64_t sequence_ = 0;
  bool recorded_ = false;
};

Spawn box(const std::string& name, const Vector3& place) {
  Spawn spawn;
  spawn.request.name = name;
  spawn.request.shape = "box";
  spawn.request.size = {0.03, 0.04, 0.05};
  spawn.request.mass = 0.05;
  spawn.request.pose.position = place;
  spawn.request.twist.angular = {0.0, 0.1, 1.0 / 3.0};
  spawn.request.material = "{static_friction: 0.9}";
  return spawn;
}

Spawn spanner(const std::string& name, const Vector3& place) {
  Spawn spawn;
  spawn.request.name = name;
  spawn.request.urdf =
      "<robot name='m'><link name='m'><inertial><mass value='0.1'/><inertia ixx='1e-4' iyy='1e-4' izz='1e-4' "
      "ixy='0' ixz='0' iyz='0'/></inertial><collision><geometry><mesh "
      "filename='package://mr_hand_interaction/config/meshes/spanner.stl'/></geometry></collision></link></"
      "robot>";
  spawn.request.pose.position = place;
  return spawn;
}

/// A cube is taken and carried; the recorder comes while it is held, and then everything is changed.
Live eventful() {
  const auto frames = test::motion_frames("grasp_cube", kRate, 0);
  Configuration configuration;
  set_parameter(configuration, "gravity", "[0, 0, -0.1]");
  Live live("config/scenes/cube.urdf", configuration);
  live.change(box("early", {0.4, 0.0, 0.3}));
  live.change(spanner("mesh", {-0.5, 0.0, 0.3}));
  live.change(box("gone", {0.4, 0.3, 0.3}));
  live.change(Delete{"gone"});
  live.play(frames, 0.0, 3.0);
  live.begin_recording();
  live.play(frames, 3.0, 3.5);
  live.change(SetParameters{{{"filter/window", "5"}, {"filter/type", "window"}, {"gravity", "[0, 0, 0.1]"}}});
  live.play(frames, 3.5, 4.0);
  live.change(PlaceObject{"early", {{0.1, -0.3, 0.4}, Quaternion(0.6, 0.0, 0.8, 0.0)}});
  live.change(spanner("late", {-0.5, 0.5, 0.3}));
  live.change(Delete{"mesh"});
  live.play(frames, 4.0, 4.5);
  live.without_hands(0.6);
  live.change(Reset{});
  live.play(frames, 6.0, 6.5);
  return live;
}

struct ReplayedLog {
  YAML::Node run(const Live& live) {
    arguments.input = "hand.bag";
    arguments.output = folder / "out";
    Entries log(live.entries);
    replay_log(arguments, log, "simulation_input");
    return YAML::LoadFile(folder / "out/summary.json");
  }

  test::Folder folder;
  ReplayArguments arguments;
};

TEST(ReplayLog, a_recording_that_begins_in_the_middle_gives_the_live_run_s_hash_after_every_entry) {
  ReplayedLog replayed;
  const Live live = eventful();
  const YAML::Node summary = replayed.run(live), run = summary["live_run"];
  EXPECT_EQ(run["compared"].as<std::size_t>(), live.entries.size());
  EXPECT_EQ(run["same"].as<std::size_t>(), live.entries.size());
  EXPECT_TRUE(run["parts_at"].IsNull());
  EXPECT_EQ(run["changes"].size(), 5u);
  EXPECT_EQ(summary["not_known"].size(), 0u);
  EXPECT_EQ(summary["gravity"][2].as<double>(), -0.1);
}

TEST(ReplayLog, a_grasp_that_a_deletion_or_a_reset_ends_has_its_end_among_the_events) {
  const auto frames = test::motion_frames("grasp_cube", kRate, 0);
  for (const Change& change : {Change(Delete{"cube"}), Change(Reset{})}) {
    SCOPED_TRACE(to_text(change));
    Live live("config/scenes/cube.urdf", Configuration());
    live.play(frames, 0.0, 0.5);
    live.begin_recording();
    live.play(frames, 0.5, 3.0);
    live.change(change);
    live.play(frames, 3.0, 3.1);
    const YAML::Node events = ReplayedLog().run(live)["events"];
    ASSERT_EQ(events["GRASP_BEGIN"].as<int>(0), 1);
    EXPECT_EQ(events["GRASP_END"].as<int>(0), 1);
    EXPECT_EQ(events["CONTACT_END"].as<int>(0), events["CONTACT_BEGIN"].as<int>());
  }
}

/// The shipped hatch, `higher`.
Spawn hatch(double higher) {
  Spawn spawn;
  spawn.request.whole = true;
  spawn.request.urdf = file_text("config/scenes/hatch.urdf", 1u << 20).value();
  spawn.request.pose.position = {0.0, 0.3, higher};
  return spawn;
}

TEST(ReplayLog, a_device_that_was_there_is_gone_and_came_again_is_there_once) {
  const auto frames = test::motion_frames("grasp_cube", kRate, 0);
  Live live("config/scenes/cube.urdf", Configuration());
  live.change(hatch(0.0));
  live.change(Delete{"wall"});
  live.change(hatch(0.1));
  live.change(Delete{"latch_top"});
  live.play(frames, 0.0, 1.0);
  live.begin_recording();
  live.play(frames, 1.0, 2.0);
  live.change(Delete{"wall"});
  live.change(hatch(0.2));
  live.play(frames, 2.0, 2.5);
  const YAML::Node summary = ReplayedLog().run(live), run = summary["live_run"];
  EXPECT_EQ(run["same"].as<std::size_t>(), live.entries.size());
  EXPECT_EQ(summary["not_known"].size(), 0u);
}

TEST(ReplayLog, what_is_left_out_of_the_log_is_told_with_the_time_from_which_all_is_other) {
  Live live = eventful();
  const auto change = std::find_if(live.entries.begin(), live.entries.end(), [](const LogEntry& entry) {
    return entry.kind == LogEntry::Kind::change;
  });
  change->text = "set: [[gravity, \"[0, 0, 5]\"]]";  // as if something had not been recorded
  const YAML::Node run = ReplayedLog().run(live)["live_run"];
  EXPECT_NEAR(run["parts_at"].as<double>(), 0.49, 0.02);  // half a second after the recording's first frame
  EXPECT_LT(run["same"].as<int>(), run["compared"].as<int>());
}

TEST(ReplayLog, lost_entries_are_counted_and_the_next_beginning_is_gone_on_from) {
  Live live = eventful();
  live.begin_recording();  // who listens next
  live.play(test::motion_frames("grasp_cube", kRate, 0), 6.5, 6.8);
  live.entries.erase(live.entries.begin() + 20, live.entries.begin() + 30);
  const YAML::Node run = ReplayedLog().run(live)["live_run"];
  EXPECT_EQ(run["missing"].as<int>(), 10);
  EXPECT_EQ(run["same"].as<int>(), run["compared"].as<int>());
  EXPECT_GT(run["compared"].as<int>(), 20 + 25);
}

TEST(ReplayLog, options_given_by_hand_stand_above_what_was_recorded_and_are_told) {
  ReplayedLog replayed;
  replayed.arguments.scene = "cube";  // as recorded: nothing is other by this
  replayed.arguments.settings = {{"gravity", "[0, 0, -2]"}};
  const YAML::Node summary = replayed.run(eventful());
  ASSERT_EQ(summary["live_run"]["overridden"].size(), 1u);
  EXPECT_EQ(summary["live_run"]["overridden"][0].as<std::string>(),
            "gravity=[0, 0, -2] instead of [0, 0, -0.1]");
  EXPECT_EQ(summary["live_run"]["compared"].as<int>(), 0);
  EXPECT_EQ(summary["gravity"][2].as<double>(), -2.0);
}

TEST(ReplayLog, another_version_s_state_or_parameters_are_told_and_the_rest_is_done) {
  Live live = eventful();
  LogEntry& begin = live.entries.front();
  begin.state[0] = static_cast<char>(begin.state[0] ^ 1);
  begin.text.replace(begin.text.find("version: "), 9, "version: 9");
  begin.text.replace(begin.text.find("hand/pad"), 8, "hand/pud");
  const YAML::Node summary = ReplayedLog().run(live);
  EXPECT_EQ(summary["not_known"].size(), 3u);
  EXPECT_GT(summary["frames"].as<int>(), 100);
  EXPECT_EQ(summary["error"].IsDefined(), false);
}

/// Formats have been told by one number more for each change, the first 8 bytes of a state.
TEST(ReplayLog, a_state_of_an_older_or_newer_format_gives_one_line_and_begins_at_the_scene_s_start) {
  for (const int step : {-3, -2, -1, 1}) {
    Live live = eventful();
    std::string& state = live.entries.front().state;
    std::uint64_t format = 0;
    std::memcpy(&format, state.data(), sizeof format);
    format += static_cast<std::uint64_t>(step);
    std::memcpy(&state[0], &format, sizeof format);
    ReplayedLog replayed;
    const YAML::Node summary = replayed.run(live);
    ASSERT_EQ(summary["not_known"].size(), 1u) << step;
    const std::string line = summary["not_known"][0].as<std::string>();
    EXPECT_EQ(line.find('\n'), std::string::npos);
    EXPECT_NE(line.find("of another version"), std::string::npos) << line;
    EXPECT_GT(summary["frames"].as<int>(), 100);
    EXPECT_EQ(summary["live_run"]["parts_at"].as<double>(), 0.0) << "from its first entry on";
    // The cube is where the scene has it, and in no hand: the recording began as it was held.
    const std::string first = test::lines_of(replayed.folder / "out/objects.csv").at(1);
    const Scene scene = load_scene("config/scenes/cube.urdf", {});
    const std::vector<std::string> cells = text::split(first.substr(first.find("cube,") + 5));
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(std::stod(cells.at(static_cast<std::size_t>(axis))),
                  scene.bodies.back().start.position[axis], 1e-3)
          << first;  // 0.1 m/s^2, 10 ms
    }
  }
}

TEST(ReplayLog, the_scene_is_built_from_the_recording_alone) {
  const test::Folder folder;
  std::filesystem::create_directory(folder / "scene");
  std::filesystem::copy("config/meshes/spanner.stl", folder / "scene/part.stl");
  std::ofstream(folder / "scene/own.urdf")
      << "<robot name='own'><link name='world'/><link name='part'><inertial><mass value='0.1'/><inertia "
         "ixx='1e-4' "
         "iyy='1e-4' izz='1e-4' ixy='0' ixz='0' iyz='0'/></inertial><collision><geometry><mesh "
         "filename=\"part.stl\"/>"
         "</geometry></collision></link><joint name='j' type='floating'><parent link='world'/><child "
         "link='part'/>"
         "</joint></robot>";
  std::ofstream(folder / "scene/own.yaml")
      << "materials: {part: {static_friction: 0.7, dynamic_friction: 0.5}}";
  Live live(folder / "scene/own.urdf", Configuration());
  live.begin_recording();
  live.play(test::motion_frames("grasp_cube", kRate, 0), 0.0, 1.0);
  std::filesystem::remove_all(folder / "scene");
  const YAML::Node summary = ReplayedLog().run(live);
  EXPECT_EQ(summary["live_run"]["same"].as<std::size_t>(), live.entries.size());
  EXPECT_EQ(summary["materials"]["part"]["static_friction"].as<double>(), 0.7);
}

// A glTF has its vertices in another file, perhaps in a folder below.
TEST(ReplayLog, a_mesh_that_names_other_files_is_replayed_without_them) {
  test::Folder scene;
  const std::string& folder = scene.path();
  std::filesystem::create_directories(folder + "/meshes/buffers");
  scene.write("meshes/part.gltf", test::gltf_of("buffers/part.bin"));
  scene.write("meshes/buffers/part.bin", test::gltf_buffer());
  const std::string mesh = "<collision><geometry><mesh filename='meshes/part.gltf'/></geometry></collision>";
  Live live(scene.write("own.urdf", test::thing(test::kInertial + mesh)), Configuration());
  live.begin_recording();
  Spawn spawn = box("late", {0.5, 0.0, 0.3});
  spawn.request.shape.clear(), spawn.request.size.clear();
  spawn.request.folder = folder;
  spawn.request.urdf = "<robot name='o'><link name='l'>" + mesh + "</link></robot>";
  live.change(spawn);
  live.play(test::motion_frames("grasp_cube", kRate, 0), 0.0, 0.1);
  std::filesystem::remove_all(folder + "/meshes");
  EXPECT_EQ(ReplayedLog().run(live)["live_run"]["same"].as<std::size_t>(), live.entries.size());
}

TEST(ReplayLog, a_recorded_file_stays_in_the_folder_of_the_replay_whatever_its_name) {
  const test::Folder folder;
  for (const auto& [name, path] : written_to(
           folder.path() + "/in", {{"../../a.obj", "1"}, {"file:///b/../../../c.obj", "2"}, {"/d.obj", "3"}}))
    EXPECT_EQ(std::filesystem::canonical(path).string().find(folder.path() + "/in/0/"), 0u) << name;
  EXPECT_EQ(written_to(folder.path() + "/in", {{"/d.obj", "3"}})["/d.obj"], folder.path() + "/in/0/d.obj");
  EXPECT_EQ(written_to(folder.path() + "/in", {{"/d.obj", "4"}})["/d.obj"], folder.path() + "/in/1/d.obj");
}

// What shows the markers reads the meshes' files after the replay has ended.
TEST(ReplayLog, markers_keep_every_mesh_of_the_recording_beside_them) {
  const auto mesh = [](const std::string& name, double x) {
    Spawn spawn = box(name, {x, 0.0, 0.3});
    spawn.request.shape.clear(), spawn.request.size.clear();
    spawn.request.urdf = "<robot name='o'><link name='part'><collision><geometry><mesh filename='" + name +
                         ".obj'/></geometry></collision></link></robot>";
    return spawn;
  };
  const test::Folder folder;
  Live live("config/scenes/cube.urdf", Configuration());
  live.begin_recording();
  std::vector<std::string> shapes;
  for (const std::string& size : {std::string("03"), std::string("04")}) {
    shapes.push_back("v 0 0 0\nv ." + size + " 0 0\nv 0 ." + size + " 0\nv 0 0 ." + size +
                     "\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    Spawn spawn = mesh("of_" + size, 0.1 * std::stod(size));
    spawn.request.folder = folder / "";
    std::ofstream(folder / ("of_" + size + ".obj")) << shapes.back();
    live.change(spawn);
  }
  live.play(test::motion_frames("grasp_cube", kRate, 0), 0.0, 0.1);
  ReplayedLog replayed;
  replayed.arguments.marker_frames = {1};
  replayed.run(live);
  std::set<std::string> kept;
  for (const auto& file : std::filesystem::recursive_directory_iterator(replayed.folder / "out/files"))
    if (file.path().extension() == ".obj") kept.insert(file_text(file.path().string(), 1000).value());
  EXPECT_EQ(kept, std::set<std::string>(shapes.begin(), shapes.end()));
}

// A bag goes to others: a URDF of a stranger must not put files of this machine into it.
TEST(ReplayLog, a_recording_has_the_scenes_meshes_and_no_other_file_that_the_urdf_names) {
  const test::Folder folder;
  std::filesystem::copy("config/meshes/spanner.stl", folder / "part.stl");
  std::ofstream(folder / "secret") << "a secret";
  std::ofstream(folder / "secret.obj") << "a secret";
  const std::string secret = folder / "secret";
  const std::string urdf = "<robot name='own'><!-- filename=\"" + secret + "\" --><link name='part'>" +
                           "<visual><geometry><mesh filename='" + secret + "'/></geometry></visual>" +
                           "<visual><geometry><mesh filename='secret.obj'/></geometry></visual>" +
                           "<collision><geometry><mesh filename='" + (folder / "part.stl") +
                           "'/></geometry></collision></link><sensor filename='" + secret + "'/></robot>";
  std::ofstream(folder / "own.urdf") << urdf;
  Live live(folder / "own.urdf", Configuration());
  live.begin_recording();
  const auto names = [](const RecordedFiles& files) {
    std::vector<std::string> all;
    for (const RecordedFile& file : files) all.push_back(file.name);
    return all;
  };
  EXPECT_EQ(names(live.entries.at(0).files), (std::vector<std::string>{"scene.urdf", folder / "part.stl"}));
  Spawn spawn;
  spawn.request.name = "other";
  spawn.request.urdf = urdf;
  spawn.request.pose.position = {1, 0, 0};
  live.change(spawn);
  EXPECT_EQ(names(live.entries.at(1).files),
            (std::vector<std::string>{folder / "part.stl", "spawn/other.urdf"}));
}

TEST(ReplayLog, changes_keep_their_bits_as_text) {
  const Spawn spawn = box("a_box", {0.1, 1.0 / 3.0, -1e-17});
  const Change read = change_from_yaml(to_yaml(Change(spawn)), {});
  const ObjectRequest& request = std::get<Spawn>(read).request;
  EXPECT_EQ(request.pose.position, spawn.request.pose.position);
  EXPECT_EQ(request.twist.angular, spawn.request.twist.angular);
  EXPECT_EQ(request.material, spawn.request.material);
  EXPECT_EQ(to_yaml(read), to_yaml(Change(spawn)));
  for (const char* bad :
       {"", "[", "jump: 1", "place: x", "place: x\npose: [1, 2]", "set: [a]", "spawn: {name: x}",
        "spawn: {name: x, urdf: nowhere, pose: [0,0,0,0,0,0,1], twist: [0,0,0,0,0,0]}"})
    EXPECT_THROW(change_from_yaml(bad, {}), std::invalid_argument) << bad;
}

std::string refusal_of(const std::function<void()>& read) {
  try {
    read();
  } catch (const std::invalid_argument& error) {
    return error.what();
  } catch (const std::exception& error) {
    return std::string("of another kind: ") + error.what();
  }
  return "none";
}

TEST(ReplayLog, recorded_yaml_of_another_form_is_refused_in_our_words) {
  for (const char* bad : {"5", "[1]", "set: {a: 1}", "set: 5", "spawn: 5", "spawn: [1]", "place: {x: 1}",
                          "delete: [a]", "spawn: {name: {a: b}}", "pause: [on]"}) {
    const std::string why = refusal_of([bad] { change_from_yaml(bad, {}); });
    if (std::string(bad) == "set: 5") continue;  // no values: nothing is set
    EXPECT_EQ(why.find("recorded change: "), 0u) << bad << ": " << why;
    EXPECT_NE(why.find("; allowed: "), std::string::npos) << bad << ": " << why;
  }
  const std::string begin = "version: 1\nscene: a\n";
  for (const char* bad :
       {"object_twist: [1]", "parameters: [1]", "removed: {a: b}", "added: {a: b}", "added: [1]"}) {
    const std::string why = refusal_of([&] { world_from_yaml(begin + bad, {}); });
    EXPECT_EQ(why.find("recorded change: "), 0u) << bad << ": " << why;
  }
}

}  // namespace
}  // namespace mrhi
