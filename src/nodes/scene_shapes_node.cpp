#include <ros/ros.h>

#include <exception>

#include "../ros/node.h"
#include "../ros/scene_shapes.h"

namespace {

constexpr const char* kUsage =
    R"(usage: rosrun mr_hand_interaction scene_shapes_node [TOPIC:=OTHER]...

Takes simulation_input, live or from a bag, and publishes the shapes of the scene on scene_shapes, latched, whenever
the scene changes: once for each viewer, which moves them by objects.
)";

}  // namespace

int main(int argc, char** argv) {
  if (const auto status = mrhi::status_of_arguments(argc, argv, kUsage)) return *status;
  ros::init(argc, argv, "scene_shapes_node");
  mrhi::end_in_order();
  const ros::NodeHandle node;  // outlives what may throw: without a node nothing is logged
  const mrhi::MasterWatch master;
  try {
    const mrhi::SceneShapes shapes(node);
    ros::spin();
  } catch (const std::exception& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
  return 0;
}
