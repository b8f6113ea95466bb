#include "hand_chain.h"

namespace mrhi {

void HandChain::begin(const Hand& tracked, const PalmLag& lag) {
  tracked_ = &tracked;
  lags_behind_ = nullptr;
  if (!lag.zero()) {
    lags_behind_ = &tracked;
    turn_palm(tracked, lag, turned_);
    tracked_ = &turned_;
  }
  shift_.setZero();
  known_.fill(false);
}

/// A finger that has had a chain goes through it from then on, also without an offset: its joints must be
/// known as placed now.
void HandChain::place(const HandOffset& offset, Hand& placed) {
  shift_ = offset.shift;
  placed.palm = {tracked_->palm.position + shift_, tracked_->palm.orientation};
  placed.wrist = tracked_->wrist + shift_;
  for (std::size_t c = 0; c < kCapsules; ++c) {
    const Capsule& from = tracked_->capsules[c];
    if (from.radius <= 0.0) continue;
    const int moves = finger_that_moves(static_cast<int>(c));
    if (moves >= 0 && known_[static_cast<std::size_t>(moves)]) continue;
    placed.capsules[c].start = from.start + shift_;
    placed.capsules[c].end = from.end + shift_;
  }
  for (int f = 0; f < kFingers; ++f) {
    const FingerOffset& turned = offset.fingers[static_cast<std::size_t>(f)];
    if (known_[static_cast<std::size_t>(f)] || !(turned == 0.0).all())
      finger(f).place(*tracked_, turned, shift_, placed);
  }
}

FingerChain& HandChain::finger(int index) {
  const auto f = static_cast<std::size_t>(index);
  if (!known_[f]) {
    fingers_[f] = FingerChain(*tracked_, index, shift_, lags_behind_);
    known_[f] = true;
  }
  return fingers_[f];
}

}  // namespace mrhi
