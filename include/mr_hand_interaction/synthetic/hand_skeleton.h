#pragma once

// Deprecated, until the release after 1.0: the contents are in tracking/hand_skeleton.h.
#include "mr_hand_interaction/tracking/hand_skeleton.h"
