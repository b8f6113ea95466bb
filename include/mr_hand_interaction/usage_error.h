#pragma once

// Deprecated, until the release after 1.0: the contents are in input_error.h.
#include "mr_hand_interaction/input_error.h"
