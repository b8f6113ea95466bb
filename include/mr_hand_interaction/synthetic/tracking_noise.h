#pragma once

// Deprecated, until the release after 1.0: the contents are in synthetic/synthetic_hand.h.
#include "mr_hand_interaction/synthetic/synthetic_hand.h"
