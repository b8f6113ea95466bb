// A scene's URDF, its YAML, and a file of parameters. What is taken is a scene that can be simulated.
#include <cmath>

#include "fuzz/target.h"
#include "mr_hand_interaction/parameters.h"
#include "mr_hand_interaction/scene/object_request.h"
#include "mr_hand_interaction/scene/scene_loader.h"
#include "support/fixtures.h"

namespace {

using namespace mrhi;

std::optional<Configuration> parameters(const std::string& text) {
  Configuration configuration;
  try {
    load_parameters(configuration, fuzzing::folder().write("parameters.yaml", text));
  } catch (const ParameterError& error) {
    fuzzing::require_one_line(error.what());
    return {};
  }
  return configuration;
}

void simulate(const Scene& scene, const Configuration& configuration) {
  Simulation simulation(scene, configuration);
  for (int i = 0; i < 4; ++i) {
    const Vector3 tip(0.01 * i, 0.0, 0.0);
    simulation.advance(
        {mrhi::testing::at(0.005 * i), {mrhi::testing::finger(tip, tip + Vector3(0, 0.03, 0), 0.008)}});
    fuzzing::require(simulation.result().not_finite.empty(), "what comes out is finite");
  }
}

/// The URDF as one of a service call, and a primitive whose sizes are the YAML's first bytes.
void request(const std::string& urdf, const std::string& yaml) {
  ObjectRequest whole, object, primitive;
  whole.urdf = object.urdf = urdf.find('<') == std::string::npos ? "<" : urdf;
  whole.whole = true;
  primitive.name = "thing";
  primitive.shape = "capsule";
  for (std::size_t i = 0; i < 3; ++i) {
    const int byte = i < yaml.size() ? static_cast<unsigned char>(yaml[i]) : 0;
    (i < 2 ? primitive.size.emplace_back() : primitive.mass) = std::pow(10.0, byte / 16.0 - 8.0) - 1e-8;
  }
  for (const ObjectRequest& one : {whole, object, primitive}) {
    try {
      requested_scene(one, {});
    } catch (const SceneError& error) {
      fuzzing::require_one_line(error.what());
    }
  }
}

}  // namespace

FUZZ_TARGET(scene) {
  const std::vector<std::string> parts = fuzzing::parts_of(data, size, 3);
  const auto configuration = parameters(parts[2]);
  const std::string urdf = fuzzing::folder().write("scene.urdf", parts[0]);
  fuzzing::folder().write("scene.yaml", parts[1]);
  request(parts[0], parts[1]);
  try {
    simulate(load_scene(urdf, {}), configuration.value_or(Configuration()));
  } catch (const SceneError& error) {
    fuzzing::require_one_line(error.what());
  }
}
