#pragma once

namespace mrhi {

/// A pressed object leaves a phalanx no faster than this: the spring gives back ever less of its force as the
/// two part, none at this speed. It is what damps a held object; it acts only where something touches, and
/// never pulls [m/s].
constexpr double kReleaseSpeed = 0.1;

/// 1 / kReleaseSpeed where contact/release_fade is on, else 0: the spring gives back all that it has taken
/// [s/m].
constexpr double release_fade(bool on) {
  return on ? 1.0 / kReleaseSpeed : 0.0;
}

}  // namespace mrhi
