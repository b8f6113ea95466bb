#include "stamp_steps.h"

#include <algorithm>
#include <cstdlib>

#include "mr_hand_interaction/stamp_check.h"

namespace mrhi {
namespace {

/// Receipts of two frames may be late by so much, one against the other. What comes all at once is no
/// witness.
constexpr Nanoseconds kJitter = 20'000'000;

bool goes_evenly(Nanoseconds by_stamp, Nanoseconds by_receipt) {
  return by_stamp > 0 && 4 * by_receipt > by_stamp && by_receipt - by_stamp < kJitter + by_stamp;
}

/// Of a slow stream, frames may be so many times as far apart as the last two were.
constexpr Nanoseconds kIntervals = 4;

}  // namespace

/// Receipts that go back are those of a recording that begins anew: so does all here.
StampSteps::Verdict StampSteps::take(Nanoseconds stamp, const std::optional<Nanoseconds>& receipt) {
  if (!receipt || std::abs(stamp) > StampCheck::kLatest || std::abs(*receipt) > StampCheck::kLatest)
    return {stamp + correction_};
  const Frame frame{stamp, *receipt};
  if (last_ && frame.receipt - last_->receipt < -StampCheck::kBack) *this = StampSteps();
  if (!last_) return accept(frame);
  const Nanoseconds since = frame.stamp - last_->stamp;
  const Nanoseconds passed = std::max<Nanoseconds>(0, frame.receipt - last_->receipt);
  const Nanoseconds longest =
      std::max({StampCheck::kAhead, kIntervals * interval_, passed + StampCheck::kAhead});
  if (since > 0 && since <= longest) return accept(frame);
  const std::optional<Frame> before = off_;
  off_ = frame;
  if (!before || !goes_evenly(frame.stamp - before->stamp, frame.receipt - before->receipt))
    return {stamp + correction_};
  Verdict verdict{stamp};
  if (accepted_ == 1) {
    verdict.first_was_off = true;
  } else {
    verdict.is_step = true;
    correction_ += last_->stamp + passed - frame.stamp;
  }
  verdict.stamp = accept(frame).stamp;
  return verdict;
}

StampSteps::Verdict StampSteps::accept(const Frame& frame) {
  interval_ = last_ && !off_ ? std::min(frame.stamp - last_->stamp, StampCheck::kBack) : 0;
  last_ = frame;
  off_.reset();
  ++accepted_;
  return {frame.stamp + correction_};
}

}  // namespace mrhi
