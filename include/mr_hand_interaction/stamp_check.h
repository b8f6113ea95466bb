#pragma once

#include <cstdint>
#include <optional>

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// Relation of a frame to its stream.
enum class StampVerdict : std::uint8_t {
  follows,  ///< continues the stream
  late,     ///< repeats, or goes back by little: out of order
  behind,   ///< far back, and single so far: a stray, or the first of a restarted stream
  ahead,    ///< far ahead, and single so far: a stray, or the first after a gap
  restart,  ///< the third of a stream that continues from an earlier time
  no_time   ///< outside the range of a stamp
};

/// Distinguishes stray stamps from a stream that restarts or has a gap: the latter are accepted once a
/// further frame continues from there. So a stray frame from the past or the future is dropped without other
/// effect. A real gap costs its first frame, unless a clock confirms it, and a real restart its first two.
/// Far ahead is more than kAhead, and more than four times the last interval of a slow stream. Plain state:
/// copies continue alike.
struct StampCheck {
  static constexpr Nanoseconds kAhead = 100'000'000;
  static constexpr Nanoseconds kBack = 500'000'000;
  static constexpr Nanoseconds kLatest = 2'147'483'647'000'000'000;  ///< range of a ros::Duration

  bool started = false;
  Nanoseconds last = 0;      ///< stamp of the last accepted frame
  Nanoseconds interval = 0;  ///< between the last two; 0: unknown
  Nanoseconds stray = 0;     ///< newest far-off stamp
  int strays = 0;            ///< number of consecutive far-off frames

  StampVerdict check(Nanoseconds stamp) { return check(stamp, last, {}); }
  /// `reached`: simulated time, at least `last`; stamps up to it are late. `expected`: stamp of a frame sent
  /// now, by the receiver's clock, if there is one.
  StampVerdict check(Nanoseconds stamp, Nanoseconds reached, const std::optional<Nanoseconds>& expected);

 private:
  StampVerdict take(Nanoseconds stamp, Nanoseconds since, StampVerdict verdict);
  /// Returns the number of consecutive far-off frames, which are at most `max_interval` apart.
  int note_stray(Nanoseconds stamp, Nanoseconds max_interval);
};

}  // namespace mrhi
