#pragma once

#include <geometry_msgs/PoseArray.h>
#include <geometry_msgs/TransformStamped.h>
#include <geometry_msgs/Wrench.h>
#include <mr_hand_interaction/ContactArray.h>
#include <mr_hand_interaction/HandFrame.h>
#include <mr_hand_interaction/HapticsArray.h>
#include <mr_hand_interaction/InteractionEvent.h>
#include <mr_hand_interaction/ObjectStateArray.h>
#include <mr_hand_interaction/SceneDescription.h>
#include <mr_hand_interaction/SpawnObject.h>
#include <mr_hand_interaction/SpawnUrdf.h>
#include <sensor_msgs/JointState.h>
#include <std_msgs/Header.h>

#include <array>
#include <string>
#include <vector>

#include "mr_hand_interaction/scene/object_request.h"
#include "mr_hand_interaction/simulation.h"

namespace mrhi {

/// What messages tell of: a scene, what came of a frame, and where everything is then.
struct Outcome {
  const Scene& scene;
  const FrameResult& result;
  const SimulationState& state;
};

/// What has happened, as messages in world (header.frame_id). Tracked hands are those after the filter.
mr_hand_interaction::HandFrame tracked_message(const Outcome& outcome, const std_msgs::Header& header);
mr_hand_interaction::HandFrame rendered_message(const Outcome& outcome, const std_msgs::Header& header);
mr_hand_interaction::ObjectStateArray objects_message(const Outcome& outcome, const std_msgs::Header& header);
mr_hand_interaction::ContactArray contacts_message(const Outcome& outcome, const std_msgs::Header& header);
/// The scene's joints, in its order: place, velocity, and what the joint's own forces gave [rad or m].
sensor_msgs::JointState joint_states_message(const Outcome& outcome, const std_msgs::Header& header);
mr_hand_interaction::InteractionEvent event_message(const Scene& scene, const FrameResult& result,
                                                    const Event& event, const std_msgs::Header& header);
/// The frame of each object's URDF link, named after the object; fixtures too.
std::vector<geometry_msgs::TransformStamped> object_transforms(const Scene& scene,
                                                               const SimulationState& state,
                                                               const std_msgs::Header& header);

/// What every hand feels by `contacts` (sorted by key): an entry for each phalanx and object that touch or
/// strike.
mr_hand_interaction::HapticsArray haptics_message(const Scene& scene, const SimulationState& state,
                                                  const std::vector<Contact>& contacts,
                                                  const std_msgs::Header& header);

mr_hand_interaction::SceneDescription scene_message(const Scene& scene, const Configuration& configuration,
                                                    const std_msgs::Header& header);

/// 21 joints in the order of the tracker reader, each with x along the bone that ends or, of wrist and
/// knuckles, begins there; a joint that the hand has not is NaN.
geometry_msgs::PoseArray pose_array_message(const Hand& hand, const std_msgs::Header& header);

/// What hands do to a body: the sum of the contacts' forces, and their torque about the centre of mass, in
/// world axes [N, N m]. Blows (impulses) are not in it.
geometry_msgs::Wrench wrench_message(std::size_t body, const FrameResult& result,
                                     const SimulationState& state);

/// The names of what is held, in the scene's order, with commas between them.
std::string held_objects(const Scene& scene, const SimulationState& state);

/// Kinds of shapes by the number that SceneShape.msg gives them; behind them come meshes.
constexpr std::array<const char*, mr_hand_interaction::SceneShape::MESH> kShapeTypes{
    {"sphere", "box", "cylinder", "capsule"}};

ObjectRequest from_message(const mr_hand_interaction::SpawnObject::Request& message);
ObjectRequest from_message(const mr_hand_interaction::SpawnUrdf::Request& message);

}  // namespace mrhi
