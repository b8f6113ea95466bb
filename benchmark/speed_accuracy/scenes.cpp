#include "experiment.h"

namespace mrhi::benchmark {

std::vector<ScenePlan> all_scenes() {
  std::vector<ScenePlan> scenes;
  add_pinch_scenes(scenes);
  add_free_rotation_scenes(scenes);
  add_impact_scenes(scenes);
  add_gravity_scenes(scenes);
  add_elastic_scenes(scenes);
  add_squeeze_scenes(scenes);
  add_catch_scenes(scenes);
  add_recording_scenes(scenes);
  add_cost_scenes(scenes);
  add_crowd_scenes(scenes);
  add_joint_scenes(scenes);
  return scenes;
}

}  // namespace mrhi::benchmark
