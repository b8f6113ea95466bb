#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "engine.h"

namespace mrhi::benchmark {

/// One row of the result: the scene's name with `suffix` behind it.
struct Measure {
  std::string suffix;
  double error = 0.0;
  std::string unit;
  bool failed = false;  ///< the run is no answer at all: object lost, passed through, blown up
};

/// One run of a scene: its worlds, the hand's motion in them, and what is made of the outcome.
class Experiment {
 public:
  virtual ~Experiment() = default;
  virtual int trials() const { return 1; }
  virtual World world(int trial) const = 0;
  virtual double duration() const = 0;  ///< of a trial [s]
  /// Where the hand's parts are at time t; `poses` has one per World::kinematics.
  virtual void hand(int /*trial*/, double /*t*/, std::vector<Pose>& /*poses*/) const {}
  /// Whether observe() asks how hard the hand's parts are pressed.
  virtual bool watches_forces() const { return false; }
  /// After each step. False ends the trial: nothing more to be learnt.
  virtual bool observe(int trial, double t, const Engine& engine) = 0;
  virtual std::vector<Measure> measures() const = 0;
  /// One more run of the same engine, before the one that counts, with this step [s]; 0: none.
  virtual double reference_step() const { return 0.0; }
  /// The run so far was the reference; the one that counts begins.
  virtual void reference_done() {}
};

struct ScenePlan {
  std::string name;
  std::string group;          ///< name by which several are chosen together
  std::vector<double> steps;  ///< step lengths [s]; empty: all
  std::function<std::unique_ptr<Experiment>(bool quick)> make;
  std::function<void(const EngineMaker& ours)> prepare = nullptr;  ///< before the first run; may be empty
  bool full_only = false;                                          ///< left out by --quick
  std::string missing = {};                                        ///< why it cannot be run here, or empty
  double budget = 10.0;                                            ///< of a contender, unless --quick [s]
};

/// All scenes, in the order in which they are run.
std::vector<ScenePlan> all_scenes();

// One file each, in experiments/.
void add_pinch_scenes(std::vector<ScenePlan>& scenes);
void add_free_rotation_scenes(std::vector<ScenePlan>& scenes);
void add_impact_scenes(std::vector<ScenePlan>& scenes);
void add_gravity_scenes(std::vector<ScenePlan>& scenes);
void add_elastic_scenes(std::vector<ScenePlan>& scenes);
void add_squeeze_scenes(std::vector<ScenePlan>& scenes);
void add_catch_scenes(std::vector<ScenePlan>& scenes);
void add_recording_scenes(std::vector<ScenePlan>& scenes);
void add_cost_scenes(std::vector<ScenePlan>& scenes);
void add_crowd_scenes(std::vector<ScenePlan>& scenes);
void add_joint_scenes(std::vector<ScenePlan>& scenes);

}  // namespace mrhi::benchmark
