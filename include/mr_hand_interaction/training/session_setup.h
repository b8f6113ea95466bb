#pragma once

// Deprecated, until the release after 1.0: the contents are in training/session.h.
#include "mr_hand_interaction/training/session.h"
