#pragma once

// Deprecated, until the release after 1.0: the contents are in scene/body.h.
#include "mr_hand_interaction/scene/body.h"
