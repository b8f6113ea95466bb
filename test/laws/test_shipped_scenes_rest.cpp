#include <gtest/gtest.h>

#include "mr_hand_interaction/response/contact_model.h"
#include "mr_hand_interaction/scene/scene_loader.h"
#include "support/fixtures.h"

namespace mrhi {
namespace {

class ShippedScene : public ::testing::TestWithParam<const char*> {};

TEST_P(ShippedScene, keeps_its_objects_where_they_start_until_a_hand_comes) {
  const Configuration configuration;
  SceneOptions options;
  options.default_material = default_material(configuration);
  Simulation simulation(load_scene(std::string("config/scenes/") + GetParam() + ".urdf", options),
                        configuration);
  for (int frame = 0; frame <= 200; ++frame) simulation.advance({testing::at(frame / 100.0), {}});
  for (std::size_t b = 0; b < simulation.scene().bodies.size(); ++b) {
    const Body& body = simulation.scene().bodies[b];
    // What stands on a table sinks in by m g / k: a tenth of a micrometre.
    EXPECT_LT((simulation.state().bodies[b].pose.position - body.start.position).norm(), 1e-6) << body.name;
    EXPECT_LT(testing::object_twist(simulation, b).linear.norm(), 1e-9) << body.name;
  }
}

INSTANTIATE_TEST_SUITE_P(All, ShippedScene,
                         ::testing::Values("cube", "flat_cuboid", "long_cuboid", "ball", "mixed", "rack",
                                           "cube_on_table"));

}  // namespace
}  // namespace mrhi
