#pragma once

#include <ostream>
#include <vector>

#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {

/// Writes frames in the CSV schema of recordings: a line per hand and frame, hand_id -1 for a frame without
/// hands, time from the first stamp, micrometres. What a frame does not have is left empty.
void write_recording_csv(std::ostream& out, const std::vector<JointsFrame>& frames);

}  // namespace mrhi
