#pragma once

#include <geometry_msgs/TransformStamped.h>
#include <mr_hand_interaction/ContactArray.h>
#include <mr_hand_interaction/HandFrame.h>
#include <mr_hand_interaction/InteractionEvent.h>
#include <mr_hand_interaction/ObjectStateArray.h>
#include <mr_hand_interaction/SpawnObject.h>
#include <mr_hand_interaction/SpawnUrdf.h>
#include <sensor_msgs/JointState.h>
#include <std_msgs/Header.h>

#include <vector>

#include "mr_hand_interaction/scene/object_request.h"
#include "mr_hand_interaction/simulation.h"

namespace mrhi {

/// What has happened, as messages in world (header.frame_id). Tracked hands are those after the filter.
mr_hand_interaction::HandFrame tracked_message(const FrameResult& result, const std_msgs::Header& header);
mr_hand_interaction::HandFrame rendered_message(const FrameResult& result, const std_msgs::Header& header);
mr_hand_interaction::ObjectStateArray objects_message(const Scene& scene, const FrameResult& result,
                                                      const SimulationState& state,
                                                      const std_msgs::Header& header);
mr_hand_interaction::ContactArray contacts_message(const Scene& scene, const FrameResult& result,
                                                   const SimulationState& state,
                                                   const std_msgs::Header& header);
mr_hand_interaction::InteractionEvent event_message(const Scene& scene, const FrameResult& result,
                                                    const Event& event, const std_msgs::Header& header);
/// The scene's joints, in its order: place, velocity, and what the joint's own forces gave [rad or m].
sensor_msgs::JointState joint_states_message(const Scene& scene, const SimulationState& state,
                                             const std_msgs::Header& header);
/// The frame of each object's URDF link, named after the object; fixtures too.
std::vector<geometry_msgs::TransformStamped> object_transforms(const Scene& scene,
                                                               const SimulationState& state,
                                                               const std_msgs::Header& header);

ObjectRequest from_message(const mr_hand_interaction::SpawnObject::Request& message);
ObjectRequest from_message(const mr_hand_interaction::SpawnUrdf::Request& message);

}  // namespace mrhi
