#include "mr_hand_interaction/replay/replay.h"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "mr_hand_interaction/scene/scene_loader.h"
#include "replay/replay_files.h"
#include "replay/run.h"

namespace mrhi {
namespace {

constexpr double kTrackerRate = 90.0;
const char* const kTables[] = {"objects.csv", "contacts.csv", "hands.csv", "events.csv"};

struct Replayed {
  explicit Replayed(const std::string& motion) : scene(make_motion(motion).scene) {
    arguments.scene = "config/scenes/" + scene + ".urdf";
    arguments.input =
        test::write_recording(folder / "recording.csv", test::motion_frames(motion, kTrackerRate, 0));
    arguments.output = folder / "out";
  }

  YAML::Node run(const std::string& name) {
    arguments.output = folder / name;
    replay(arguments);
    return YAML::LoadFile(folder / (name + "/summary.json"));
  }

  std::string table(const std::string& name, const std::string& file) const {
    return test::text_of(folder / (name + "/" + file));
  }

  std::string usage_error() {
    try {
      replay(arguments);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  }

  test::Folder folder;
  std::string scene;
  ReplayArguments arguments;
};

TEST(Replay, the_same_input_twice_gives_the_same_bytes) {
  Replayed replayed("nudge");
  const YAML::Node first = replayed.run("first"), second = replayed.run("second");
  for (const char* file : kTables) {
    EXPECT_EQ(replayed.table("first", file), replayed.table("second", file)) << file;
    EXPECT_GT(test::lines_of(replayed.folder / (std::string("first/") + file)).size(), 1u) << file;
  }
  for (const auto& field : first) {
    const auto name = field.first.as<std::string>();
    if (name == "step_time_us") continue;
    EXPECT_EQ(YAML::Dump(field.second), YAML::Dump(second[name])) << name;
  }
}

TEST(Replay, every_frame_has_its_rows_and_the_nudged_object_moves) {
  Replayed replayed("nudge");
  const YAML::Node summary = replayed.run("out");
  const auto recording = read_recording_csv(replayed.arguments.input);
  EXPECT_EQ(summary["frames"].as<std::size_t>(), recording.size());
  EXPECT_EQ(summary["rejected"].size(), 0u);
  // The stamps are rounded to microseconds in the file.
  EXPECT_NEAR(summary["simulated_seconds"].as<double>(),
              to_seconds(recording.back().stamp - recording.front().stamp), 1e-9);
  EXPECT_GT(summary["steps"].as<std::size_t>(), recording.size());
  const auto objects = test::lines_of(replayed.folder / "out/objects.csv");
  EXPECT_EQ(objects.size(), 1 + recording.size());  // scenes of motions have one free body
  const std::size_t name_end = objects[1].find(',', objects[1].find(',') + 1);
  EXPECT_NE(objects[1].substr(name_end),
            objects.back().substr(objects.back().find(',', objects.back().find(',') + 1)));
}

TEST(Replay, unusable_frames_are_counted_and_the_run_goes_on) {
  Replayed replayed("nudge");
  auto frames = test::motion_frames("nudge", kTrackerRate, 0);
  frames[10].stamp = frames[9].stamp;
  frames[20].hands[0].palm_centre = Vector3(50, 0, 0);
  test::write_recording(replayed.arguments.input, frames);
  const YAML::Node summary = replayed.run("out");
  EXPECT_EQ(summary["frames"].as<std::size_t>(), frames.size() - 2);
  EXPECT_EQ(summary["rejected"][to_string(Rejection::stamp_not_increasing)].as<int>(), 1);
  EXPECT_EQ(summary["rejected"]["unusable hand"].as<int>(), 1);
}

/// Times of the events of a kind in a run's events.csv [s].
std::vector<double> times_of(const std::string& kind, const std::string& events) {
  std::vector<double> times;
  for (const std::string& line : test::lines_of(events))
    if (line.find("," + kind + ",") != std::string::npos) times.push_back(std::stod(line));
  return times;
}

// Up to hold_time. The first frame after a gap of more than 0.1 s was left out.
TEST(Replay, a_gap_in_a_recording_that_is_shorter_than_hold_time_drops_nothing) {
  Replayed replayed("grasp_cube");
  const auto whole = read_recording_csv(replayed.arguments.input);
  for (const double gap : {0.12, 0.18, 0.195}) {
    std::vector<JointsFrame> frames;
    for (const JointsFrame& frame : whole)
      if (to_seconds(frame.stamp) < 4.0 || to_seconds(frame.stamp) > 4.0 - 1.0 / kTrackerRate + gap)
        frames.push_back(frame);
    test::write_recording(replayed.arguments.input, frames);
    const YAML::Node summary = replayed.run("out");
    EXPECT_EQ(summary["rejected"].size(), 0u) << gap;
    const auto ends = times_of("GRASP_END", replayed.folder / "out/events.csv");
    ASSERT_EQ(ends.size(), 1u) << gap;
    EXPECT_GT(ends[0], 5.5) << gap;
  }
}

TEST(Replay, a_stray_stamp_far_ahead_is_left_out_alone) {
  Replayed replayed("nudge");
  auto frames = test::motion_frames("nudge", kTrackerRate, 0);
  frames[10].stamp += 5'000'000'000;
  test::write_recording(replayed.arguments.input, frames);
  const YAML::Node summary = replayed.run("out");
  EXPECT_EQ(summary["frames"].as<std::size_t>(), frames.size() - 1);
  EXPECT_EQ(summary["rejected"][to_string(Rejection::stamp_ahead)].as<int>(), 1);
}

// The hand sways by 0.1 m once a second while it holds the cube. Frames that arrive together and are stamped
// then made it seem to jerk, and it lost the cube.
TEST(Replay, frames_that_arrive_in_bursts_do_not_drop_what_the_hand_holds) {
  Replayed replayed("grasp_cube");
  for (const std::size_t size : {3u, 6u}) {
    auto frames = test::motion_frames("grasp_cube", 115.0, 0);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const double t = to_seconds(frames[i].stamp), sway = std::clamp(t - 3.2, 0.0, 2.0);
      const Vector3 by(0.1 * std::min(1.0, 3.0 * std::min(sway, 2.0 - sway)) * std::sin(2.0 * M_PI * sway), 0,
                       0);
      for (HandJoints& hand : frames[i].hands) {
        *hand.palm_centre += by;
        *hand.wrist += by;
        for (auto& finger : hand.joints)
          for (auto& joint : finger)
            if (joint) *joint += by;
      }
    }
    for (std::size_t first = 0; first + size <= frames.size(); first += size)
      for (std::size_t i = 0; i < size; ++i)
        frames[first + i].stamp = frames[first + size - 1].stamp + static_cast<Nanoseconds>(i) * 300'000;
    test::write_recording(replayed.arguments.input, frames);
    replayed.run("out");
    const auto begins = times_of("GRASP_BEGIN", replayed.folder / "out/events.csv"),
               ends = times_of("GRASP_END", replayed.folder / "out/events.csv");
    ASSERT_EQ(begins.size(), 1u) << size;
    ASSERT_EQ(ends.size(), 1u) << size;
    EXPECT_LT(begins[0], 3.2) << size;
    EXPECT_GT(ends[0], 5.5) << size;
  }
}

TEST(Replay, objects_start_where_and_as_they_are_told) {
  Replayed replayed("nudge");
  const Scene scene = load_scene(replayed.arguments.scene, {});
  replayed.arguments.object_poses = {{scene.bodies[0].name, {{0.5, 0.4, 0.3}, Quaternion(0, 1, 0, 0)}}};
  replayed.arguments.object_twists = {{scene.bodies[0].name, {{0.1, 0, 0}, {0, 0, 0}}}};
  replayed.run("out");
  const auto lines = test::lines_of(replayed.folder / "out/objects.csv");
  EXPECT_EQ(lines[1], "0," + scene.bodies[0].name + ",0.5,0.4,0.3,1,0,0,0,0.1,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0");
}

TEST(Replay, objects_scenes_and_parameters_on_the_command_line_must_exist) {
  Replayed replayed("nudge");
  const ReplayArguments good = replayed.arguments;
  const std::string object = load_scene(good.scene, {}).bodies[0].name;
  replayed.arguments.object_poses = {{"teapot", Pose{}}};
  EXPECT_NE(replayed.usage_error().find("'teapot'; allowed: " + object), std::string::npos);
  replayed.arguments = good;
  replayed.arguments.object_twists = {{"world", Twist{}}};
  EXPECT_NE(replayed.usage_error().find("'world'"), std::string::npos);
  replayed.arguments = good;
  replayed.arguments.object_poses = {{object, {{0, 0, 900}, Quaternion::Identity()}}};
  EXPECT_NE(replayed.usage_error().find("bounds"), std::string::npos);
  replayed.arguments = good;
  replayed.arguments.settings = {{"filter/windw", "3"}};
  EXPECT_NE(replayed.usage_error().find("filter/windw"), std::string::npos);
  replayed.arguments = good;
  replayed.arguments.scene = "config/scenes/no_such_scene.urdf";
  EXPECT_NE(replayed.usage_error().find("no_such_scene"), std::string::npos);
}

/// Ends with an error after some frames.
struct BreakingSource : FrameSource {
  std::optional<SourceFrame> next() override {
    if (position_ == 5) throw std::runtime_error("it broke");
    SourceFrame frame;
    frame.frame = HandFrame{1'000'000'000 + 10'000'000 * static_cast<Nanoseconds>(position_++), {}};
    return frame;
  }
};

TEST(Replay, what_was_written_before_an_error_stays) {
  Replayed replayed("nudge");
  Simulation simulation = prepare_simulation(replayed.arguments);
  replayed.arguments.output = replayed.folder / "out";
  {
    ReplayRun run(replayed.arguments, "");
    run.begin(simulation, "nudge");
    BreakingSource source;
    EXPECT_THROW(run_frames(source, simulation, run), std::runtime_error);
    EXPECT_EQ(run.summary.frames, 5u);
  }
  EXPECT_EQ(test::lines_of(replayed.folder / "out/objects.csv").size(), 6u);
}

TEST(Replay, a_recording_without_a_usable_frame_is_an_error) {
  Replayed replayed("nudge");
  auto frames = test::motion_frames("nudge", kTrackerRate, 0);
  frames.resize(1);
  frames[0].hands[0].palm_centre = Vector3(50, 0, 0);
  test::write_recording(replayed.arguments.input, frames);
  replayed.arguments.output = replayed.folder / "new/out";
  EXPECT_THROW(replay(replayed.arguments), std::runtime_error);
  EXPECT_FALSE(std::filesystem::exists(replayed.folder / "new"));
  // A folder that was there before stays, with the reason.
  std::filesystem::create_directories(replayed.arguments.output);
  EXPECT_THROW(replay(replayed.arguments), std::runtime_error);
  EXPECT_NE(test::text_of(replayed.folder / "new/out/summary.json").find("\"error\""), std::string::npos);
}

ReplaySummary some_summary() {
  ReplaySummary summary;
  summary.scene = "cube";
  summary.input = "a \"quoted\" \\ name\n.csv";
  summary.frames = 3;
  summary.simulated_seconds = 0.25;
  summary.steps = 250;
  summary.step_time.add(2000);
  summary.deepest_rendered = 1.5e-4;
  summary.rejected["unusable hand"] = 2;
  summary.events["GRASP_BEGIN"] = 1;
  summary.held_at_end = {"cube"};
  summary.state_hash = 0xabc;
  summary.version = "1.2.3";
  summary.gravity = {0.0, 0.0, -9.81};
  summary.parameters["hand/pad"] = "0";
  summary.materials["cube"].static_friction = 0.75;
  return summary;
}

// JSON is YAML.
TEST(ReplaySummaryJson, holds_what_the_summary_holds) {
  const YAML::Node json = YAML::Load(to_json(some_summary()));
  EXPECT_EQ(json["scene"].as<std::string>(), "cube");
  EXPECT_EQ(json["input"].as<std::string>(), some_summary().input);
  EXPECT_EQ(json["frames"].as<int>(), 3);
  EXPECT_EQ(json["simulated_seconds"].as<double>(), 0.25);
  EXPECT_EQ(json["steps"].as<int>(), 250);
  for (const char* quantile : {"p50", "p99", "max"}) {
    EXPECT_NEAR(json["step_time_us"][quantile].as<double>(), 2.0, 0.02) << quantile;  // bins of 2 %
  }
  EXPECT_EQ(json["deepest_rendered_penetration_m"].as<double>(), 1.5e-4);
  EXPECT_EQ(json["rejected"]["unusable hand"].as<int>(), 2);
  EXPECT_EQ(json["events"]["GRASP_BEGIN"].as<int>(), 1);
  EXPECT_EQ(json["version"].as<std::string>(), "1.2.3");
  EXPECT_EQ(json["gravity"][2].as<double>(), -9.81);
  EXPECT_EQ(json["parameters"]["hand/pad"].as<std::string>(), "0");
  EXPECT_EQ(json["materials"]["cube"]["static_friction"].as<double>(), 0.75);
  EXPECT_EQ(json["objects_held_at_end"][0].as<std::string>(), "cube");
}

TEST(ReplaySummaryJson, tells_how_it_stands_to_the_live_run_and_what_is_not_known) {
  ReplaySummary summary = some_summary();
  EXPECT_FALSE(YAML::Load(to_json(summary))["live_run"].IsDefined());
  summary.rejected["stamp far ahead"] = 4;
  summary.not_known = {"scene"};
  summary.live.emplace();
  summary.live->lost_by_queue = 9;
  summary.live->compared = summary.live->same = 7;
  summary.live->changes = {"0.100 s: reset"};
  const YAML::Node json = YAML::Load(to_json(summary));
  EXPECT_EQ(json["frames_lost"]["by_queue"].as<int>(), 9);
  EXPECT_EQ(json["frames_lost"]["by_stamp"].as<int>(), 4);
  EXPECT_EQ(json["frames_lost"]["by_order"].as<int>(), 0);
  EXPECT_EQ(json["live_run"]["same"].as<int>(), 7);
  EXPECT_TRUE(json["live_run"]["parts_at"].IsNull());
  EXPECT_EQ(json["live_run"]["changes"][0].as<std::string>(), "0.100 s: reset");
  EXPECT_EQ(json["not_known"][0].as<std::string>(), "scene");
}

TEST(ReplaySummaryJson, the_hash_is_sixteen_hex_digits) {
  EXPECT_NE(to_json(some_summary()).find("\"state_hash\": \"0000000000000abc\""), std::string::npos);
}

TEST(ReplaySummaryJson, an_error_is_there_only_if_there_was_one) {
  ReplaySummary summary = some_summary();
  EXPECT_FALSE(YAML::Load(to_json(summary))["error"]);
  summary.error = "disk full";
  EXPECT_EQ(YAML::Load(to_json(summary))["error"].as<std::string>(), "disk full");
}

}  // namespace
}  // namespace mrhi
