#pragma once

#include "mr_hand_interaction/training/task.h"
#include "mr_hand_interaction/training/trial.h"

namespace mrhi {

/// Whether the goal asks for a hand that holds the object.
bool asks_to_hold(GoalKind kind);
/// Whether it asks for a touch without a grasp.
bool asks_to_touch(GoalKind kind);

/// Whether the goal's condition holds now; `start`: where the object was as the trial began. For kinds with a
/// condition that lasts: pick, place, insert, catch_it, nudge_into, joint, rest.
bool is_met(const Goal& goal, const Observation& seen, const Vector3& start);

}  // namespace mrhi
