#pragma once

#include "mr_hand_interaction/scene/body.h"

namespace mrhi {

/// A box around all shapes of a body, along its axes; body frame [m].
struct BodyBox {
  Vector3 centre = Vector3::Zero();
  Vector3 half = Vector3::Zero();
};

BodyBox box_around(const Body& body);

}  // namespace mrhi
