#pragma once

// Deprecated, until the release after 1.0: the contents are in rendering/rendered_hand.h.
#include "mr_hand_interaction/rendering/rendered_hand.h"
