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
  Comparison compare(const std::string& first, const std::string& second) const {
    write("a", first);
    write("b", second);
    return compare_runs(folder / "a", folder / "b");
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
  EXPECT_EQ(to_text(comparison), "1 of 1 objects the same to the last digit\n");
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
  EXPECT_NEAR(ball.farthest, 0.3, 1e-12);
  EXPECT_EQ(cube.time, 0.2);
  EXPECT_EQ(cube.place.x(), 1.5);
  EXPECT_NEAR(cube.distance, 0.25, 1e-12);
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
  for (const std::vector<std::string>& wrong : {std::vector<std::string>{"--compare"},
                                                {"--compare", "a"},
                                                {"--compare", "a", "b", "c"},
                                                {"--scene", "cube", "--compare"}})
    EXPECT_THROW(parse_replay_arguments(wrong), UsageError);
}

}  // namespace
}  // namespace mrhi
