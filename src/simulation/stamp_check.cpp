#include "mr_hand_interaction/stamp_check.h"

#include <algorithm>

namespace mrhi {
namespace {

constexpr int kRestartFrames = 3, kGapFrames = 2;
/// Longest gap of a slow stream, in intervals of its last two frames.
constexpr Nanoseconds kMaxIntervals = 4;

/// Longest gap after an interval, limited so that it does not overflow.
Nanoseconds max_gap(Nanoseconds interval) {
  return kMaxIntervals * std::min(interval, StampCheck::kLatest / kMaxIntervals);
}

}  // namespace

StampVerdict StampCheck::check(Nanoseconds stamp, Nanoseconds reached,
                               const std::optional<Nanoseconds>& expected) {
  if (stamp < -kLatest || stamp > kLatest) return StampVerdict::no_time;
  if (!started) return take(stamp, 0, StampVerdict::follows);
  const Nanoseconds before = stray;
  if (stamp > reached) {
    const Nanoseconds usual = interval > 0 ? kAhead : kBack;
    const bool expected_by_clock = expected && stamp - kAhead <= *expected;
    if (expected_by_clock || stamp - last <= std::max(usual, max_gap(interval)))
      return take(stamp, stamp - last, StampVerdict::follows);
    if (note_stray(stamp, std::max(kBack, max_gap(stray - last))) < kGapFrames) return StampVerdict::ahead;
    return take(stamp, stamp - before, StampVerdict::follows);
  }
  if (reached - stamp <= kBack) return StampVerdict::late;
  if (note_stray(stamp, kBack) < kRestartFrames) return StampVerdict::behind;
  return take(stamp, stamp - before, StampVerdict::restart);
}

StampVerdict StampCheck::take(Nanoseconds stamp, Nanoseconds since, StampVerdict verdict) {
  started = true;
  last = stamp;
  interval = since;
  strays = 0;
  return verdict;
}

int StampCheck::note_stray(Nanoseconds stamp, Nanoseconds max_interval) {
  const bool same_side = (stray > last) == (stamp > last);
  const bool continues = strays > 0 && same_side && stamp > stray && stamp - stray <= max_interval;
  strays = continues ? strays + 1 : 1;
  stray = stamp;
  return strays;
}

}  // namespace mrhi
