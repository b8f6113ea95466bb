#pragma once

// Deprecated, until the release after 1.0: the contents are in integration/body_state.h.
#include "mr_hand_interaction/integration/body_state.h"
