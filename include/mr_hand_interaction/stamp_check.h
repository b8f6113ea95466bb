#pragma once

#include <cstdint>
#include <optional>

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// Position of a frame in its stream.
enum class StampVerdict : std::uint8_t {
  follows,  ///< continues the stream
  late,     ///< repeats, or goes back by little: out of order
  behind,   ///< far back, alone so far: of another time, or the first of a restarted stream
  ahead,    ///< far ahead, alone so far: of another time, or the first after a gap
  restart,  ///< the third of a stream that continues from an earlier time
  no_time   ///< outside the range of stamps
};

/// Distinguishes stray stamps from a restarted stream or a gap, which are accepted once a frame continues
/// from there. A lone frame from the past or the future is rejected and costs nothing else. A real gap costs
/// its first frame, unless a clock confirms it, and a real restart its first two. Far ahead means more than
/// kAhead, and more than four times the last interval of a slow stream. Plain state: a copy continues like
/// the original.
struct StampCheck {
  static constexpr Nanoseconds kAhead = 100'000'000;
  static constexpr Nanoseconds kBack = 500'000'000;
  static constexpr Nanoseconds kLatest = 2'147'483'647'000'000'000;  ///< range of a ros::Duration

  bool started = false;
  Nanoseconds last = 0;      ///< stamp of the last frame that followed
  Nanoseconds interval = 0;  ///< between the last two; 0: not yet known
  Nanoseconds stray = 0;     ///< newest of the frames that were far off
  int strays = 0;            ///< how many in a row go on from each other

  StampVerdict check(Nanoseconds stamp) { return check(stamp, last, {}); }
  /// `reached`: simulated time, at least `last`; stamps up to it are late. `expected`: stamp of a present
  /// frame by the receiver's clock, if there is one.
  StampVerdict check(Nanoseconds stamp, Nanoseconds reached, const std::optional<Nanoseconds>& expected);

 private:
  StampVerdict take(Nanoseconds stamp, Nanoseconds since, StampVerdict verdict);
  /// Number of successive stray frames that continue each other, at most `longest` apart.
  int note_stray(Nanoseconds stamp, Nanoseconds longest);
};

}  // namespace mrhi
