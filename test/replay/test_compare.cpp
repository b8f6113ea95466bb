#include <gtest/gtest.h>

#include "mr_hand_interaction/replay/compare.h"
#include "mr_hand_interaction/replay/replay.h"
#include "replay/replay_files.h"

namespace mrhi {
namespace {

const std::string kHeader = "time,name,px,py,pz,qx,qy,qz,qw,vx,vy,vz,wx,wy,wz\n";

std::string row(double time, const std::string& name, double x, double turn = 0.0) {
  return std::to_string(time) + "," + name + "," + std::to_string(x) + ",0,0,0,0," + std::to_string(turn) +
         ",1,0,0,0,0,0,0\n";
}

struct Runs {
  Comparison compare(const std::string& first, const std::string& second,
                     const Tolerance& within = {}) const {
    write("a", first);
    write("b", second);
    return compare_runs(folder / "a", folder / "b", within);
  }
  void write(const std::string& run, const std::string& rows) const {
    std::filesystem::create_directories(folder / run);
    std::ofstream(folder / (run + "/objects.csv")) << kHeader << rows;
  }

  test::TemporaryFolder folder;
};

TEST(CompareRuns, the_same_input_does_not_part) {
  const Runs runs;
  ReplayArguments arguments;
  arguments.scene = "config/scenes/cube.urdf";
  arguments.input = test::write_recording(runs.folder / "nudge.csv", test::motion_frames("nudge", 60.0, 0));
  for (const char* run : {"a", "b"}) {
    arguments.output = runs.folder / run;
    replay(arguments);
  }
  const Comparison comparison = compare_runs(runs.folder / "a", runs.folder / "b");
  EXPECT_EQ(comparison.objects, 1u);
  EXPECT_TRUE(comparison.partings.empty());
  EXPECT_TRUE(comparison.near_misses.empty());
  EXPECT_EQ(comparison.same_end, std::optional<bool>(true));
  EXPECT_EQ(to_text(comparison),
            "1 of 1 objects within 1e-09 m and 1e-09 rad in every frame\n"
            "objects: the same bits in every frame; the state at the end: the same bits\n");
}

TEST(CompareRuns, objects_part_at_their_first_frame_that_differs) {
  const Runs runs;
  const std::string start = row(0.0, "ball", 0.0) + row(0.0, "cube", 1.0);
  const Comparison comparison = runs.compare(
      start + row(0.1, "ball", 0.2) + row(0.1, "cube", 1.0) + row(0.2, "ball", 0.2) + row(0.2, "cube", 1.5),
      start + row(0.1, "ball", 0.2, 0.01) + row(0.1, "cube", 1.0) + row(0.2, "ball", 0.5) +
          row(0.2, "cube", 1.25));
  ASSERT_EQ(comparison.partings.size(), 2u);
  const Parting &ball = comparison.partings[0], &cube = comparison.partings[1];
  EXPECT_EQ(ball.object, "ball");
  EXPECT_EQ(ball.time, 0.1);  // by its turn
  EXPECT_EQ(ball.distance, 0.0);
  EXPECT_NEAR(ball.angle, 2.0 * std::atan(0.01), 1e-12);
  EXPECT_NEAR(ball.farthest, 0.3, 1e-12);
  EXPECT_EQ(cube.time, 0.2);
  EXPECT_EQ(cube.place.x(), 1.5);
  EXPECT_NEAR(cube.distance, 0.25, 1e-12);
}

// In single digits of a double: 7e-21 m beside the origin is rounding, and no parting.
TEST(CompareRuns, what_differs_within_the_tolerance_does_not_part_and_is_told_as_other_bits) {
  const Runs runs;
  const std::string start = row(0.0, "cube", 0.0), tiny = "0.1,cube,7e-21,0,0,0,0,1e-12,1,0,0,0,0,0,0\n";
  const std::string far = row(0.2, "cube", 0.5), farther = row(0.2, "cube", 0.7);
  const Comparison near = runs.compare(start + row(0.1, "cube", 0.0), start + tiny);
  EXPECT_TRUE(near.partings.empty());
  ASSERT_EQ(near.near_misses.size(), 1u);
  EXPECT_EQ(near.near_misses[0].time, 0.1);
  EXPECT_EQ(near.near_misses[0].farthest, 7e-21);
  EXPECT_NEAR(near.near_misses[0].most_turned, 2e-12, 1e-18);
  EXPECT_NE(to_text(near).find("cube: does not part, but differs from 0.1 s"), std::string::npos)
      << to_text(near);
  EXPECT_NE(to_text(near).find("objects: not the same bits; the state at the end: not told"),
            std::string::npos);

  const Comparison later = runs.compare(start + row(0.1, "cube", 0.0) + far, start + tiny + farther);
  ASSERT_EQ(later.partings.size(), 1u);
  EXPECT_TRUE(later.near_misses.empty());
  EXPECT_EQ(later.partings[0].time, 0.2);
  EXPECT_NEAR(later.partings[0].distance, 0.2, 1e-12);
}

TEST(CompareRuns, the_tolerance_is_chosen_and_none_asks_for_the_last_digit) {
  const Runs runs;
  const std::string a = row(0.0, "cube", 0.0), moved = row(0.0, "cube", 0.001),
                    turned = row(0.0, "cube", 0.0, 0.001);
  const std::string faster = "0,cube,0,0,0,0,0,0,1,0,0,0,0,0,1e-300\n";
  EXPECT_TRUE(runs.compare(a, moved, {0.0011, 0.0}).partings.empty());
  EXPECT_EQ(runs.compare(a, moved, {0.0009, 0.0}).partings.size(), 1u);
  EXPECT_TRUE(runs.compare(a, turned, {0.0, 0.0021}).partings.empty());
  EXPECT_EQ(runs.compare(a, turned, {0.0, 0.0019}).partings.size(), 1u);
  EXPECT_TRUE(runs.compare(a, faster).partings.empty());
  EXPECT_EQ(runs.compare(a, faster, {0.0, 0.0}).partings.size(), 1u);
}

// Contacts and filters are no rows of objects.csv.
TEST(CompareRuns, states_that_end_otherwise_are_told_where_objects_are_the_same) {
  const Runs runs;
  for (const char* run : {"a", "b"}) {
    runs.write(run, row(0.0, "cube", 0.0));
    std::ofstream(runs.folder / (run + std::string("/summary.json")))
        << "{\n  \"state_hash\": \"000000000000000" << run << "\"\n}\n";
  }
  const Comparison comparison = compare_runs(runs.folder / "a", runs.folder / "b");
  EXPECT_TRUE(comparison.partings.empty());
  EXPECT_EQ(comparison.same_end, std::optional<bool>(false));
  EXPECT_NE(to_text(comparison).find("the same bits in every frame; the state at the end: not the same bits"),
            std::string::npos);
}

TEST(CompareRuns, a_place_that_is_no_number_parts_from_one_that_is) {
  const Runs runs;
  const std::string lost = "0,cube,nan,0,0,0,0,0,1,0,0,0,0,0,0\n";
  EXPECT_EQ(runs.compare(row(0.0, "cube", 0.0), lost).partings.size(), 1u);
}

TEST(CompareRuns, a_frame_or_an_object_of_one_alone_is_told) {
  const Runs runs;
  EXPECT_EQ(runs.compare(row(0.0, "cube", 0.0), row(0.0, "ball", 0.0)).partings.size(), 2u);
  EXPECT_EQ(
      runs.compare(row(0.0, "cube", 0.0) + row(0.1, "cube", 0.0), row(0.0, "cube", 0.0)).partings.at(0).why,
      "one run ends");
  EXPECT_EQ(runs.compare(row(0.1, "cube", 0.0), row(0.2, "cube", 0.0)).partings.at(0).why,
            "a frame of one alone");
}

TEST(CompareRuns, what_is_no_run_is_refused_by_its_name) {
  const Runs runs;
  try {
    compare_runs(runs.folder / "none", runs.folder / "none");
    FAIL();
  } catch (const RecordingError& error) {
    EXPECT_NE(std::string(error.what()).find("none/objects.csv"), std::string::npos);
  }
}

TEST(CompareRuns, stands_alone_on_the_command_line) {
  EXPECT_EQ(parse_replay_arguments({"--compare", "a", "b"}).compare->second, "b");
  EXPECT_EQ(parse_replay_arguments({"--compare", "a", "b"}).tolerance.distance, 1e-9);
  EXPECT_EQ(parse_replay_arguments({"--compare", "a", "b", "--tolerance", "1e-3,0.1"}).tolerance.angle, 0.1);
  for (const std::vector<std::string>& wrong : {std::vector<std::string>{"--compare"},
                                                {"--compare", "a"},
                                                {"--compare", "a", "b", "c"},
                                                {"--scene", "cube", "--compare"},
                                                {"--tolerance", "1,1", "--compare", "a", "b"},
                                                {"--compare", "a", "b", "--tolerance"},
                                                {"--compare", "a", "b", "--tolerance", "1e-3"},
                                                {"--compare", "a", "b", "--tolerance", "-1,0"},
                                                {"--compare", "a", "b", "--tolerance", "0,nan"}})
    EXPECT_THROW(parse_replay_arguments(wrong), UsageError);
}

}  // namespace
}  // namespace mrhi
