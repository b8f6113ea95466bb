#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "engine.h"

namespace mrhi::benchmark {

/// One row of the result, named after the scene with `suffix`.
struct Measure {
  std::string suffix;
  double error = 0.0;
  std::string unit;
  bool failed = false;  ///< true if the run is invalid: object lost, passed through, or unstable
};

/// One run of a scene: its worlds, the hand's motion in them, and the evaluation.
class Experiment {
 public:
  virtual ~Experiment() = default;
  virtual int trials() const { return 1; }
  virtual World world(int trial) const = 0;
  virtual double duration() const = 0;  ///< of a trial [s]
  /// Poses of the hand's parts at time t; `poses` has one for each of World::kinematics.
  virtual void hand(int /*trial*/, double /*t*/, std::vector<Pose>& /*poses*/) const {}
  /// True if observe() reads the load on the hand's parts.
  virtual bool watches_forces() const { return false; }
  /// Call after each step. Returns false to end the trial early.
  virtual bool observe(int trial, double t, const Engine& engine) = 0;
  virtual std::vector<Measure> measures() const = 0;
  /// Step of a reference run of the same engine before the measured one [s]; 0: none.
  virtual double reference_step() const { return 0.0; }
  /// Ends the reference run; the measured one begins.
  virtual void reference_done() {}
};

struct ScenePlan {
  std::string name;
  std::string group;          ///< common name of several scenes
  std::vector<double> steps;  ///< step lengths [s]; empty: all
  std::function<std::unique_ptr<Experiment>(bool quick)> make;
  std::function<void(const EngineMaker& ours)> prepare = nullptr;  ///< before the first run; may be empty
  bool full_only = false;                                          ///< omitted by --quick
  std::string missing = {};                                        ///< why it cannot be run here, or empty
  double budget = 10.0;                                            ///< of a contender, unless --quick [s]
};

/// All scenes, in order of execution.
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
