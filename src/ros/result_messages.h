#pragma once

#include <geometry_msgs/PoseArray.h>
#include <geometry_msgs/TransformStamped.h>
#include <geometry_msgs/Wrench.h>
#include <mr_hand_interaction/ContactArray.h>
#include <mr_hand_interaction/HandFrame.h>
#include <mr_hand_interaction/HapticsArray.h>
#include <mr_hand_interaction/InteractionEvent.h>
#include <mr_hand_interaction/ObjectStateArray.h>
#include <mr_hand_interaction/RenderedView.h>
#include <mr_hand_interaction/SceneDescription.h>
#include <mr_hand_interaction/SimulationInput.h>
#include <mr_hand_interaction/SpawnObject.h>
#include <mr_hand_interaction/SpawnUrdf.h>
#include <sensor_msgs/JointState.h>
#include <std_msgs/Header.h>

#include <array>
#include <set>
#include <string>
#include <vector>

#include "mr_hand_interaction/scene/object_request.h"
#include "mr_hand_interaction/simulation.h"

namespace mrhi {
struct LogEntry;

/// Input of messages: a scene, the results of a frame, and the state after it.
struct Outcome {
  const Scene& scene;
  const FrameResult& result;
  const SimulationState& state;
};

/// Results as messages in world (header.frame_id). Tracked hands are filtered.
mr_hand_interaction::HandFrame tracked_message(const Outcome& outcome, const std_msgs::Header& header);
mr_hand_interaction::HandFrame rendered_message(const Outcome& outcome, const std_msgs::Header& header);
mr_hand_interaction::ObjectStateArray objects_message(const Outcome& outcome, const std_msgs::Header& header);
mr_hand_interaction::ContactArray contacts_message(const Outcome& outcome, const std_msgs::Header& header);
/// All four.
mr_hand_interaction::RenderedView view_message(const Outcome& outcome, const std_msgs::Header& header);
/// The scene's joints, in order: position, velocity, and the joint's own forces as effort [rad or m].
sensor_msgs::JointState joint_states_message(const Outcome& outcome, const std_msgs::Header& header);
mr_hand_interaction::InteractionEvent event_message(const Scene& scene, const FrameResult& result,
                                                    const Event& event, const std_msgs::Header& header);
/// The frame of each object's URDF link, with the object's name; fixtures included.
std::vector<geometry_msgs::TransformStamped> object_transforms(const Scene& scene,
                                                               const SimulationState& state,
                                                               const std_msgs::Header& header);

/// Loads of each hand: an entry per phalanx and object in contact or impact. `contacts`: sorted by key.
mr_hand_interaction::HapticsArray haptics_message(const Scene& scene, const SimulationState& state,
                                                  const std::vector<Contact>& contacts,
                                                  const std_msgs::Header& header);

mr_hand_interaction::SceneDescription scene_message(const Scene& scene, const Configuration& configuration,
                                                    const std_msgs::Header& header);

/// 21 joints in the order of the tracker reader, each with x along the bone that ends there, or begins at
/// wrist and knuckles. A missing joint is NaN.
geometry_msgs::PoseArray pose_array_message(const Hand& hand, const std_msgs::Header& header);

/// Hands' contact forces on a body, without impacts, and torque about its centre of mass; world [N, N m].
geometry_msgs::Wrench wrench_message(std::size_t body, const FrameResult& result,
                                     const SimulationState& state);

/// Names of held objects, in the scene's order, separated by commas.
std::string held_objects(const Scene& scene, const SimulationState& state);

/// Names of shapes by their number in SceneShape.msg, except meshes, which follow.
constexpr std::array<const char*, mr_hand_interaction::SceneShape::MESH> kShapeTypes{
    {"sphere", "box", "cylinder", "capsule"}};

/// Grip force of the hands on these bodies: half the sum of the normal forces [N].
double grip_force(const mr_hand_interaction::ContactArray& message, const std::set<std::string>& bodies);

ObjectRequest from_message(const mr_hand_interaction::SpawnObject::Request& message);
ObjectRequest from_message(const mr_hand_interaction::SpawnUrdf::Request& message);

/// A frame with unusable hands has none, and the fault as its text. Throws std::invalid_argument for an
/// unknown kind.
LogEntry from_message(const mr_hand_interaction::SimulationInput& message);

}  // namespace mrhi
