#include "scene_shapes.h"

#include <cstdio>
#include <string>
#include <vector>

#include "../record/world.h"
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
    if (input.kind == SimulationInput::BEGIN) begin(input);
    if (input.kind == SimulationInput::CHANGE && simulation_) change(input);
  } catch (const std::exception& error) {
    ROS_WARN("the scene is not shown: %s", text::one_line(error.what()).c_str());
  }
}

void SceneShapes::begin(const SimulationInput& input) {
  const World world = world_from_yaml(input.text, files_of(input));
  std::vector<std::string> unknown;
  const Configuration configuration = configuration_of(world, unknown);
  simulation_ =
      std::make_unique<LiveSimulation>(scene_of(world, configuration, meshes_.path()), configuration);
  publish();
}

void SceneShapes::change(const SimulationInput& input) {
  const RecordedFiles files = files_of(input);
  Change change = change_from_yaml(input.text, files);
  // Neither changes what is there.
  if (std::holds_alternative<PlaceObject>(change) || std::holds_alternative<Pause>(change)) return;
  if (auto* const spawn = std::get_if<Spawn>(&change))
    spawn->request.urdf = with_meshes_in(meshes_.path(), spawn->request.urdf, files);
  make(change, *simulation_);
  publish();
}

void SceneShapes::publish() const {
  const Simulation& simulation = simulation_->simulation();
  publisher_.publish(scene_shapes(simulation.scene(), simulation.configuration(), "world"));
}

}  // namespace mrhi
