#pragma once

#include <mr_hand_interaction/SpawnObject.h>
#include <mr_hand_interaction/SpawnUrdf.h>

#include "mr_hand_interaction/scene/object_request.h"

namespace mrhi {

ObjectRequest from_message(const mr_hand_interaction::SpawnObject::Request& message);
ObjectRequest from_message(const mr_hand_interaction::SpawnUrdf::Request& message);

}  // namespace mrhi
