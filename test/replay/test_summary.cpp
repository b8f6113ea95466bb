#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "replay/run.h"

namespace mrhi {
namespace {

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
