#include "scene_shapes.h"

#include <algorithm>
#include <cstdio>
#include <string>
#include <variant>
#include <vector>

#include "../record/record_yaml.h"
#include "../text/text.h"
#include "marker_layers.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"

namespace mrhi {
namespace {

using mr_hand_interaction::SimulationInput;
using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

constexpr int kQueue = 1000;  // of inputs; a lost change would show a wrong scene

RecordedFiles files_of(const SimulationInput& input) {
  RecordedFiles files;
  for (const auto& file : input.files) files.push_back({file.name, {file.bytes.begin(), file.bytes.end()}});
  return files;
}

void make_triangle_list(const TriangleMesh& mesh, Marker& marker) {
  marker.type = Marker::TRIANGLE_LIST;
  marker.scale = vector_message(Vector3::Ones());
  marker.mesh_resource.clear();
  for (const auto& triangle : mesh.triangles)
    for (const int vertex : triangle)
      marker.points.push_back(to_message(mesh.vertices[static_cast<std::size_t>(vertex)]));
}

void add_visual(const Visual& visual, const Pose& frame, int id, MarkerLayer& layer) {
  const auto& c = visual.rgba;
  Marker& marker = add_shape(visual.shape, frame * visual.pose, color(c[0], c[1], c[2], c[3]), id, layer);
  marker.colors.clear();  // the viewer has lights of its own
  if (const Mesh* const mesh = std::get_if<Mesh>(&visual.shape)) make_triangle_list(*mesh->triangles, marker);
}

/// Makes a change of a world, as far as it is seen; false if it is not.
struct Shown {
  const RecordedFiles& files;
  World& world;

  bool operator()(const Spawn& spawn) const {
    world.added.push_back(spawn.request);
    for (const RecordedFile& file : files)
      if (find_file(world.files, file.name) == nullptr) world.files.push_back(file);
    return true;
  }
  bool operator()(const Delete& remove) const {
    const auto added = std::find_if(
        world.added.begin(), world.added.end(),
        [&](const ObjectRequest& request) { return !request.whole && request.name == remove.name; });
    if (added == world.added.end()) {
      world.removed.push_back(remove.name);
    } else {
      world.added.erase(added);
    }
    return true;
  }
  bool operator()(const SetParameters& set) const {
    for (const auto& [name, value] : set.values)
      if (!grasp_parameter(name)) world.parameters[name] = value;
    return true;
  }
  template <class Other>
  bool operator()(const Other& /*places what is there*/) const {
    return false;
  }
};

std::string title(const Scene& scene, const Configuration& configuration) {
  const double g = configuration.gravity.value_or(scene.gravity).norm();
  char gravity[32] = "none";
  if (g > 0.0) std::snprintf(gravity, sizeof gravity, "%.2f m/s2", g);
  return scene.name + "  |  " + std::string(configuration.contact_model.name) + "  |  gravity: " + gravity;
}

}  // namespace

MarkerArray scene_shapes(const Scene& scene, const Configuration& configuration,
                         const std::string& fixed_frame) {
  MarkerArray array;
  for (const Body& body : scene.bodies) {
    std_msgs::Header header;
    header.frame_id = body.fixed ? fixed_frame : body.name;
    MarkerLayer layer(array, header, body.name, 0.0);
    const Pose frame = body.fixed ? body.start : Pose{};
    int id = 0;
    for (const Visual& visual : body.visuals) add_visual(visual, frame, id++, layer);
    if (!body.visuals.empty()) continue;
    for (const PlacedShape& placed : body.shapes) add_visual({placed.shape, placed.pose}, frame, id++, layer);
  }
  std_msgs::Header header;
  header.frame_id = fixed_frame;
  MarkerLayer(array, header, "text", 0.0)
      .add(0, Marker::TEXT_VIEW_FACING, Pose{}, Vector3::Constant(0.011), color(0.9, 0.9, 0.9))
      .text = title(scene, configuration);
  return array;
}

SceneShapes::SceneShapes(ros::NodeHandle node)
    : publisher_(node.advertise<MarkerArray>("scene_shapes", 1, true)),
      subscriber_(node.subscribe<SimulationInput>(
          "simulation_input", kQueue,
          boost::function<void(const SimulationInput::ConstPtr&)>(
              [this](const SimulationInput::ConstPtr& input) { take(*input); }))) {}

void SceneShapes::take(const SimulationInput& input) {
  try {
    if (input.kind == SimulationInput::BEGIN) {
      world_ = world_from_yaml(input.text, files_of(input));
    } else if (input.kind == SimulationInput::CHANGE && world_) {
      const RecordedFiles files = files_of(input);
      if (!std::visit(Shown{files, *world_}, change_from_yaml(input.text, files))) return;
    } else {
      return;
    }
    publish();
  } catch (const std::exception& error) {
    ROS_WARN("the scene is not shown: %s", text::one_line(error.what()).c_str());
  }
}

void SceneShapes::publish() const {
  std::vector<std::string> unknown;
  const Configuration configuration = configuration_of(*world_, unknown);
  publisher_.publish(scene_shapes(scene_of(*world_, configuration, files_.path()), configuration, "world"));
}

}  // namespace mrhi
