#pragma once

namespace mrhi {

/// A pressed object leaves a phalanx no faster than this: the spring gives back ever less of its force as the
/// two part, none at this speed. It is what damps a held object; it acts only where something touches, and
/// never pulls [m/s].
constexpr double kReleaseSpeed = 0.1;

}  // namespace mrhi
