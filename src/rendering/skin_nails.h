#pragma once

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// How far a place on the rest hand's skin is a nail, and how far the edge of one, 0 to 1.
struct SkinNail {
  double nail = 0.0, edge = 0.0;
};
SkinNail skin_nail(const Vector3& vertex);

}  // namespace mrhi
