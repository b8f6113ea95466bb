#include <cstdio>

#include "mr_hand_interaction/simulation.h"

int main() {
  mrhi::Scene scene;
  mrhi::Body cube;
  cube.name = "cube";
  cube.shapes = {{mrhi::Box{mrhi::Vector3::Constant(0.025)}, {}}};
  cube.start_twist.linear.x() = 0.1;
  mrhi::complete(cube);
  scene.bodies = {cube};
  mrhi::Simulation simulation(scene, mrhi::Configuration());
  for (mrhi::Nanoseconds stamp = 0; stamp <= 1'000'000'000; stamp += 10'000'000)
    simulation.advance({stamp, {}});
  std::printf("%.3f\n", simulation.state().bodies[0].pose.position.x());
  return 0;
}
