#pragma once

#include <mr_hand_interaction/ObjectState.h>
#include <mr_hand_interaction/TrainingStatus.h>
#include <visualization_msgs/MarkerArray.h>

#include <optional>
#include <string>

#include "mr_hand_interaction/scene/body.h"
#include "mr_hand_interaction/training/session.h"

namespace mrhi {

/// What the participant is to do now, in a line.
std::string instruction_now(const Session& session, bool paused, bool begins_by_itself);

/// What rviz shows of a session, in the status's frame, a namespace for each layer: `target` (where the
/// object is to be; its ring fills with the time held), `places` (the others, fainter, with their numbers),
/// `path`, `object` (highlighted until it is held; `seen`: nothing if it is not there), `instructions`,
/// `timer` and `result`. They go if they are not shown again. What is to be read is nearer to the eye of
/// rviz/training.rviz than what hands do.
visualization_msgs::MarkerArray training_markers(const Session& session, const Body& body,
                                                 const mr_hand_interaction::TrainingStatus& status,
                                                 const std::optional<mr_hand_interaction::ObjectState>& seen);

}  // namespace mrhi
