#pragma once

#include <cstdint>
#include <optional>

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// Where a frame stands in the stream that it came with.
enum class StampVerdict : std::uint8_t {
  follows,  ///< on from the last one
  late,     ///< repeats, or goes back by little: out of order
  behind,   ///< far back, alone so far: of another time, or the first of a stream that begins anew
  ahead,    ///< far ahead, alone so far: of another time, or the first after a gap
  restart,  ///< the third of a stream that goes on from an earlier time
  no_time   ///< outside what a stamp can be
};

/// Tells stray stamps from a stream that has begun anew or has had a gap: both are believed once a frame goes
/// on from there. So a lone frame from the past or the future is left out and costs nothing but itself; a
/// real gap costs its first frame, unless a clock has seen it go by, and a real restart its first two. Far
/// ahead is what is further than kAhead, and than four times the last interval of a slow stream. Plain state:
/// a copy goes on as the original does.
struct StampCheck {
  static constexpr Nanoseconds kAhead = 100'000'000;
  static constexpr Nanoseconds kBack = 500'000'000;
  static constexpr Nanoseconds kLatest = 2'147'483'647'000'000'000;  ///< what a ros::Duration reaches

  bool started = false;
  Nanoseconds last = 0;      ///< stamp of the last frame that followed
  Nanoseconds interval = 0;  ///< between the last two; 0: not known yet
  Nanoseconds stray = 0;     ///< newest of the frames that were far off
  int strays = 0;            ///< how many in a row go on from each other

  StampVerdict check(Nanoseconds stamp) { return check(stamp, last, {}); }
  /// `reached`: time that has been simulated already, at least `last`; stamps up to it are late. `expected`:
  /// the stamp that a frame of now should have, by the clock of who receives them, where there is one.
  StampVerdict check(Nanoseconds stamp, Nanoseconds reached, const std::optional<Nanoseconds>& expected);

 private:
  StampVerdict take(Nanoseconds stamp, Nanoseconds since, StampVerdict verdict);
  /// How many in a row go on from each other now, at most `longest` apart.
  int note_stray(Nanoseconds stamp, Nanoseconds longest);
};

}  // namespace mrhi
