#pragma once

#include <string>

#include "explain.h"

namespace mrhi {

const char* finger_color(int finger);  ///< thumb to palm; Okabe & Ito's

/// Hand and object by lines, from two sides, shortly before a loss and at it.
std::string drawings_of(const Explanation& story, const Loss& loss);

}  // namespace mrhi
