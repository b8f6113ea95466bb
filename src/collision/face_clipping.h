#pragma once

#include "box_face.h"
#include "contact_region.h"

namespace mrhi {

/// The part of one box's face that stands over another's, in the other's coordinates along its sides; depth
/// is below the other's plane.
ContactRegion clip_face(const BoxFace& reference, const BoxFace& incident, bool reference_is_a);

}  // namespace mrhi
