#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <map>
#include <regex>
#include <sstream>

#include "../contender.h"

namespace mrhi::benchmark {
namespace {

constexpr double kStep = 0.001, kGravity = 9.81, kSeconds = 0.5;

/// A ball in free fall, optionally with a fault.
class Fall : public Experiment {
 public:
  enum class Mishap { none, exception, crash, endless };
  explicit Fall(Mishap mishap) : mishap_(mishap) {}
  double duration() const override { return mishap_ == Mishap::endless ? 1e6 : kSeconds; }
  World world(int) const override {
    World world;
    world.gravity = Vector3(0, 0, -kGravity);
    world.bodies.push_back(ball(0.02, 0.1));
    return world;
  }
  bool observe(int, double t, const Engine& engine) override {
    if (mishap_ == Mishap::exception && t > 0.1) throw std::runtime_error("mishap");
    if (mishap_ == Mishap::crash && t > 0.1) std::abort();
    error_ = (engine.motion(0).pose.position + Vector3(0, 0, 0.5 * kGravity * t * t)).norm();
    speed_error_ = (engine.motion(0).twist.linear + Vector3(0, 0, kGravity * t)).norm();
    return true;
  }
  std::vector<Measure> measures() const override {
    return {{"_place", error_, "m", false}, {"_speed", speed_error_, "m/s", false}};
  }

 private:
  Mishap mishap_;
  double error_ = 0.0, speed_error_ = 0.0;
};

ScenePlan fall(Fall::Mishap mishap = Fall::Mishap::none) {
  return {"fall", "fall", {}, [mishap](bool) { return std::make_unique<Fall>(mishap); }};
}

std::unique_ptr<Contender> run(const EngineModule& module, const std::string& setting, const ScenePlan& scene,
                               double seconds = 10.0) {
  auto contender = std::make_unique<Contender>(module, setting, scene, true, kStep, seconds);
  while (contender->work()) {
  }
  return contender;
}

EngineModule ours() {
  return engine_modules().front();
}

TEST(SpeedAccuracy, every_engine_and_setting_drops_a_body_by_half_g_t_squared) {
  for (const EngineModule& module : engine_modules()) {
    for (const std::string& setting : settings_of(module)) {
      if (module.name == "jolt" && setting == "default") continue;  // it damps all motion
      const auto contender = run(module, setting, fall());
      ASSERT_EQ(contender->trouble(), "") << module.name << " (" << setting << ")";
      const auto& measures = contender->result().measures;
      ASSERT_EQ(measures.size(), 2u);
      // Symplectic Euler, which most engines use, has an error of g t h / 2; single precision adds 1e-6.
      EXPECT_LE(measures[0].error, 0.51 * kGravity * kSeconds * kStep)
          << module.name << " (" << setting << ")";
      EXPECT_LE(measures[1].error, 1e-4) << module.name << " (" << setting << ")";
      EXPECT_GT(contender->result().time.median, 0.0);
      EXPECT_GE(contender->result().time.percentile_99, contender->result().time.median);
    }
  }
}

TEST(SpeedAccuracy, a_door_goes_with_the_hand_and_an_engine_without_hinges_is_left_out) {
  for (const ScenePlan& scene : all_scenes()) {
    if (scene.name != "door") continue;
    for (const EngineModule& module : engine_modules()) {
      if (module.name == "bullet_f32") continue;  // its error is 20 mm
      const auto contender = run(module, settings_of(module).front(), scene);
      ASSERT_EQ(contender->trouble(), "") << module.name;
      const bool hinges = module.name != "dart" && module.name != "simbody" && module.name != "box3d";
      ASSERT_EQ(contender->result().supported, hinges) << module.name;
      if (!hinges) continue;
      const auto& measures = contender->result().measures;
      ASSERT_EQ(measures.size(), 3u);
      EXPECT_FALSE(measures[0].failed) << module.name;
      EXPECT_LE(measures[0].error, 1.2) << module.name << ": mm of the hand, which 2000 N/m give way by";
      EXPECT_LE(measures[1].error, 0.2) << module.name << ": mm at the hinge";
    }
    return;
  }
  FAIL() << "no scene door";
}

TEST(SpeedAccuracy, a_cube_of_triangles_is_held_as_a_box_is_and_an_engine_without_such_bodies_is_left_out) {
  std::map<std::string, ScenePlan> scenes;
  for (const ScenePlan& scene : all_scenes()) scenes[scene.name] = scene;
  const ScenePlan& mesh = scenes.at("pinch_swing_mesh_972");
  const auto of_mesh = run(ours(), "implicit", mesh),
             of_box = run(ours(), "implicit", scenes.at("pinch_swing"));
  ASSERT_FALSE(of_mesh->result().measures.empty());
  EXPECT_FALSE(of_mesh->result().measures[0].failed);
  // The manifold's points are the mesh's corners, whose position affects the result by 1 um.
  EXPECT_NEAR(of_mesh->result().measures[0].error, of_box->result().measures[0].error, 0.001) << "mm";
  for (const EngineModule& module : engine_modules()) {
    if (module.name != "dart" && module.name != "simbody" && module.name != "box3d" && module.name != "physx")
      continue;
    EXPECT_FALSE(run(module, settings_of(module).front(), mesh)->result().supported) << module.name;
  }
}

TEST(SpeedAccuracy, settings_hold_no_comma_that_would_split_a_csv_cell) {
  for (const EngineModule& module : engine_modules()) {
    const auto settings = settings_of(module);
    EXPECT_FALSE(settings.empty()) << module.name;
    for (const std::string& setting : settings) EXPECT_EQ(setting.find(','), std::string::npos) << setting;
  }
}

TEST(SpeedAccuracy, our_settings_begin_with_the_contact_model) {
  for (const std::string& setting : settings_of(ours())) {
    const std::string model = setting.substr(0, setting.find(';'));
    EXPECT_NE(std::string("implicit seed penetration impulse virtual_spring soft_pad").find(model),
              std::string::npos)
        << setting;
  }
}

TEST(SpeedAccuracy, a_run_that_throws_has_failed_and_keeps_its_time) {
  const auto contender = run(ours(), "seed", fall(Fall::Mishap::exception));
  EXPECT_EQ(contender->trouble(), "mishap");
  ASSERT_EQ(contender->result().measures.size(), 2u);
  EXPECT_TRUE(contender->result().measures[0].failed);
  EXPECT_GT(contender->result().time.median, 0.0);
}

TEST(SpeedAccuracy, a_run_that_crashes_harms_no_other_and_is_written_as_failed) {
  std::vector<std::unique_ptr<Contender>> contenders;
  contenders.push_back(run(ours(), "seed", fall()));
  contenders.push_back(run(ours(), "seed", fall(Fall::Mishap::crash)));
  EXPECT_EQ(contenders[1]->trouble(), "crashed");
  std::ostringstream csv;
  std::map<std::string, std::vector<Measure>> measures;
  write_rows(csv, "fall", kStep, contenders, measures);
  std::istringstream lines(csv.str());
  std::string failed;
  for (std::string line; std::getline(lines, line);) {
    for (int column = 0; column < 8; ++column) line.erase(0, line.find(',') + 1);
    failed += line.front();
    EXPECT_TRUE(std::regex_search(line.substr(1), std::regex("^,[0-9]+[.][0-9]+[.][0-9]+,")))
        << "our version: " << line;
  }
  EXPECT_EQ(failed, "0011");
}

TEST(SpeedAccuracy, a_run_beyond_its_time_is_broken_off_as_too_slow) {
  EXPECT_EQ(run(ours(), "seed", fall(Fall::Mishap::endless), 0.0)->trouble(), "too slow");
}

TEST(SpeedAccuracy, the_csv_has_the_published_columns) {
  std::ostringstream csv;
  write_header(csv);
  EXPECT_EQ(csv.str(),
            "scene,engine,setting,step_s,us_per_step,us_per_step_p99,error,error_unit,failed,"
            "engine_version,date\n");
}

}  // namespace
}  // namespace mrhi::benchmark

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  std::signal(SIGPIPE, SIG_IGN);
  return RUN_ALL_TESTS();
}
