#include <gtest/gtest.h>

#include "mr_hand_interaction/replay/replay.h"

namespace mrhi {
namespace {

using Arguments = std::vector<std::string>;

Arguments with(const Arguments& more) {
  Arguments arguments{"--scene", "cube", "--input", "a.bag", "--output", "out"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

std::string refusal(const Arguments& arguments) {
  try {
    parse_replay_arguments(arguments);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

void expect_refused(const Arguments& arguments, const std::string& naming) {
  const std::string message = refusal(arguments);
  EXPECT_NE(message.find(naming), std::string::npos) << "'" << message << "' does not name " << naming;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

TEST(ReplayArguments, all_options_are_read) {
  const ReplayArguments parsed = parse_replay_arguments(with(
      {"--topic", "/t", "--params", "p.yaml", "--set", "filter/window=5", "--set", "gravity=[0, 0, -9.81]",
       "--object-pose", "cube,1,2,3,0,0,0,1", "--object-twist", "cube,1,2,3,4,5,6", "--object-twist",
       "ball,0,0,0,0,0,1", "--hand-transform", "0.1,0.2,0.3,0.707,0,0,0.707"}));
  EXPECT_FALSE(parsed.help);
  EXPECT_EQ(parsed.scene, "cube");
  EXPECT_EQ(parsed.input, "a.bag");
  EXPECT_EQ(parsed.output, "out");
  EXPECT_EQ(parsed.topic.value(), "/t");
  EXPECT_EQ(parsed.parameter_file.value(), "p.yaml");
  ASSERT_EQ(parsed.settings.size(), 2u);
  EXPECT_EQ(parsed.settings[1].first, "gravity");
  EXPECT_EQ(parsed.settings[1].second, "[0, 0, -9.81]");
  ASSERT_EQ(parsed.object_poses.size(), 1u);
  EXPECT_EQ(parsed.object_poses[0].second.position, Vector3(1, 2, 3));
  ASSERT_EQ(parsed.object_twists.size(), 2u);
  EXPECT_EQ(parsed.object_twists[0].first, "cube");
  EXPECT_EQ(parsed.object_twists[0].second.angular, Vector3(4, 5, 6));
  EXPECT_EQ(parsed.hand_transform->position, Vector3(0.1, 0.2, 0.3));
}

TEST(ReplayArguments, a_recording_is_a_bag_or_a_csv_in_upper_or_lower_case) {
  for (const std::string file : {"a.bag", "A.BAG", "a.csv", "a.Csv"})
    EXPECT_EQ(refusal({"--scene", "cube", "--input", file, "--output", "out"}), "");
  expect_refused({"--scene", "cube", "--input", "a.bag.active", "--output", "out"}, "rosbag reindex");
  expect_refused({"--scene", "cube", "--input", "a.mcap", "--output", "out"}, "FILE.bag or FILE.csv");
}

TEST(ReplayArguments, quaternions_are_brought_to_unit_length) {
  const auto parsed = parse_replay_arguments(with({"--hand-transform", "0,0,0,3,0,0,4"}));
  EXPECT_DOUBLE_EQ(parsed.hand_transform->orientation.x(), 0.6);
  EXPECT_DOUBLE_EQ(parsed.hand_transform->orientation.w(), 0.8);
}

TEST(ReplayArguments, help_needs_nothing_else) {
  EXPECT_TRUE(parse_replay_arguments({"--help"}).help);
  EXPECT_TRUE(parse_replay_arguments({"-h"}).help);
}

TEST(ReplayArguments, what_is_required_is_named_when_missing) {
  expect_refused({"--input", "a.csv", "--output", "o"}, "--scene");
  expect_refused({"--scene", "cube", "--output", "o"}, "--input");
  expect_refused({"--scene", "cube", "--input", "a.csv"}, "--output");
  expect_refused({}, "--input");
}

TEST(ReplayArguments, unknown_options_are_refused_with_those_allowed) {
  expect_refused(with({"--speed", "2"}), "'--speed'");
  expect_refused(with({"stray"}), "'stray'");
  expect_refused(with({"--speed", "2"}), "--hand-transform");
}

TEST(ReplayArguments, an_option_without_its_value_is_refused) {
  for (const char* option :
       {"--topic", "--params", "--set", "--object-pose", "--object-twist", "--hand-transform"}) {
    expect_refused(with({option}), option);
    expect_refused(with({option, "--set", "a=b"}), option);
    expect_refused(with({option, ""}), option);
  }
}

TEST(ReplayArguments, an_option_given_twice_is_refused) {
  expect_refused(with({"--scene", "ball"}), "--scene");
  expect_refused(with({"--topic", "a", "--topic", "b"}), "--topic");
}

TEST(ReplayArguments, inputs_other_than_bag_and_csv_are_refused) {
  expect_refused({"--scene", "cube", "--input", "a.txt", "--output", "o"}, "a.txt");
  expect_refused({"--scene", "cube", "--input", ".bag", "--output", "o"}, ".bag");
  expect_refused({"--scene", "cube", "--input", "a.csv", "--output", "o", "--topic", "t"}, "--topic");
}

TEST(ReplayArguments, a_setting_is_key_and_value) {
  expect_refused(with({"--set", "step"}), "KEY=VALUE");
  expect_refused(with({"--set", "=1"}), "KEY=VALUE");
}

TEST(ReplayArguments, poses_have_finite_numbers_and_a_direction) {
  expect_refused(with({"--object-pose", "cube,1,2,3"}), "4 fields instead of 8");
  expect_refused(with({"--object-pose", "cube,1,2,3,0,0,0,1,9"}), "9 fields instead of 8");
  expect_refused(with({"--object-pose", "cube,1,2,x,0,0,0,1"}), "'x'");
  expect_refused(with({"--object-pose", "cube,1,2,,0,0,0,1"}), "''");
  expect_refused(with({"--object-pose", "cube,1,2,nan,0,0,0,1"}), "'nan'");
  expect_refused(with({"--object-pose", "cube,1,2,inf,0,0,0,1"}), "'inf'");
  expect_refused(with({"--object-pose", "cube,1,2,3,0,0,0,0"}), "quaternion");
  expect_refused(with({"--object-pose", ",1,2,3,0,0,0,1"}), "name");
  expect_refused(with({"--hand-transform", "0,0,0,0,0,0,0"}), "quaternion");
  expect_refused(with({"--hand-transform", "0,0,0"}), "3 fields instead of 7");
  expect_refused(with({"--hand-transform", "1e300,0,0,0,0,0,1"}), "not within 1000 m");
  expect_refused(with({"--object-pose", "cube,0,0,-1001,0,0,0,1"}), "not within 1000 m");
  EXPECT_EQ(refusal(with({"--hand-transform", "1000,0,-1000,0,0,0,1"})), "");
}

TEST(ReplayArguments, twists_have_six_finite_numbers) {
  expect_refused(with({"--object-twist", "cube,1,2,3,4,5"}), "6 fields instead of 7");
  expect_refused(with({"--object-twist", "cube,1,2,3,4,5,1e999"}), "'1e999'");
}

TEST(ReplayArguments, a_bag_alone_is_enough) {
  const ReplayArguments parsed = parse_replay_arguments({"--input", "folder/a.bag"});
  EXPECT_EQ(parsed.scene, "");
  EXPECT_EQ(parsed.output, "folder/a_replay");
}

TEST(ReplayArguments, what_is_made_of_the_tables_is_read) {
  const ReplayArguments parsed =
      parse_replay_arguments(with({"--explain", "--export", "60", "--marker-frames", "7,3,7", "--markers",
                                   "30", "--film", "a.mp4", "--serve", "--set", "step=0.002"}));
  EXPECT_TRUE(parsed.explain && parsed.serve);
  EXPECT_EQ(parsed.export_rate, 60.0);
  EXPECT_EQ(parsed.marker_frames, (std::set<std::size_t>{3, 7}));
  EXPECT_EQ(parsed.marker_rate, 30.0);
  EXPECT_EQ(parsed.film, "a.mp4");
  EXPECT_EQ(parsed.repeatable, (Arguments{"--scene", "cube", "--input", "a.bag", "--set", "step=0.002"}));
  for (const char* rate : {"0.5", "1001", "nan", "fast"})
    expect_refused(with({"--export", rate}), "--export");
  for (const char* frames : {"x", "-1", "1.5", "1,,2"})
    expect_refused(with({"--marker-frames", frames}), "--marker-frames");
  for (const char* rate : {"0", "1001", "7,3"}) expect_refused(with({"--markers", rate}), "--markers");
  expect_refused(with({"--film", "a.gif"}), "--film");
}

TEST(ReplayArguments, a_comparison_stands_alone) {
  EXPECT_EQ(parse_replay_arguments({"--compare", "a", "b", "--tolerance", "1e-3,0.1"}).compare,
            (Arguments{"a", "b", "--tolerance", "1e-3,0.1"}));
  for (const Arguments& wrong :
       {Arguments{"--compare"}, {"--compare", "a"}, {"--scene", "cube", "--compare"}})
    expect_refused(wrong, "--compare takes the folders of two runs");
}

}  // namespace
}  // namespace mrhi
