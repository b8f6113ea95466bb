#include "mr_hand_interaction/tracking/hand_pairs.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace mrhi {
namespace {

constexpr Nanoseconds kLongest = 100'000'000;

std::size_t index(Side side) {
  return static_cast<std::size_t>(side);
}

HandFrame joined(HandFrame first, const HandFrame& second) {
  first.stamp = std::max(first.stamp, second.stamp);
  first.hands.insert(first.hands.end(), second.hands.begin(), second.hands.end());
  return first;
}

}  // namespace

/// An interval that is longer, or goes back, is a break: the next frame tells a new one.
void HandPairs::Stream::note(Nanoseconds stamp) {
  const Nanoseconds since = stamp - last;
  interval = since > 0 && since <= kLongest ? since : 0;
  last = stamp;
}

bool HandPairs::Stream::goes_on(Nanoseconds stamp) const {
  return interval > 0 && std::abs(stamp - last) <= std::min(2 * interval, kLongest);
}

/// With the faster stream's interval T, |difference| <= T / 2: no frame of that stream is nearer, so that it
/// is the right one; doubled on the left, as stamps are whole.
bool HandPairs::is_partner(Side side, Nanoseconds stamp) const {
  if (!waiting_ || waiting_side_ == side) return false;
  Nanoseconds interval = kLongest;
  for (const Stream& stream : streams_)
    if (stream.interval > 0) interval = std::min(interval, stream.interval);
  return 2 * std::abs(stamp - waiting_->stamp) <= interval;
}

/// A frame waits for one of the other side only while that goes on. What waited and found no partner is
/// dropped, not shown late: time does not go back.
std::optional<HandFrame> HandPairs::take(Side side, const HandFrame& frame) {
  streams_[index(side)].note(frame.stamp);
  if (is_partner(side, frame.stamp)) {
    const HandFrame other = *std::exchange(waiting_, std::nullopt);
    return side == Side::left ? joined(frame, other) : joined(other, frame);
  }
  waiting_.reset();
  if (!streams_[1 - index(side)].goes_on(frame.stamp)) return frame;
  waiting_ = frame;
  waiting_side_ = side;
  return std::nullopt;
}

std::optional<HandFrame> HandPairs::rest() {
  return std::exchange(waiting_, std::nullopt);
}

}  // namespace mrhi
