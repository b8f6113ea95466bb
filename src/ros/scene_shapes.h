#pragma once

#include <mr_hand_interaction/SimulationInput.h>
#include <ros/ros.h>
#include <visualization_msgs/MarkerArray.h>

#include <optional>

#include "../record/scratch_folder.h"
#include "../record/world.h"

namespace mrhi {

/// The shapes of a scene to look at: a marker for each, with the body's name as namespace and a colour
/// without light. Those of a free body are in its body frame (ObjectState), which `frame_id` names; those of
/// a fixture are in `fixed_frame`. A mesh is a list of triangles. A marker of the namespace `text` names the
/// scene, the contact model and gravity.
visualization_msgs::MarkerArray scene_shapes(const Scene& scene, const Configuration& configuration,
                                             const std::string& fixed_frame);

/// Publishes `scene_shapes`, latched, whenever the scene changes. Reads it from `simulation_input`, live or
/// from a bag, which has the scene's files by content.
class SceneShapes {
 public:
  explicit SceneShapes(ros::NodeHandle node);

 private:
  void take(const mr_hand_interaction::SimulationInput& input);
  void publish() const;

  ScratchFolder files_{"scene_shapes"};  ///< of the scene, from which it is read
  std::optional<World> world_;
  ros::Publisher publisher_;
  ros::Subscriber subscriber_;
};

}  // namespace mrhi
