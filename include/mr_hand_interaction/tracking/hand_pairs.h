#pragma once

#include <array>
#include <optional>

#include "mr_hand_interaction/tracking/hand.h"

namespace mrhi {

/// Left and right hands that come in streams of their own, brought together in frames by their stamps alone,
/// so that a replay does as the live node. Of two streams that go on, a frame waits for the other side's:
/// they belong together if they are no farther apart than half the interval of the faster stream, whose
/// frames that find no partner are left out. A stream has ended when two of its intervals, or 0.1 s, have
/// gone by without a frame.
class HandPairs {
 public:
  /// The frame that is complete with this one of a side, if one is.
  std::optional<HandFrame> take(Side side, const HandFrame& frame);
  /// What still waits, at the end of a recording.
  std::optional<HandFrame> rest();

 private:
  struct Stream {
    Nanoseconds last = 0, interval = 0;  ///< interval 0: not known
    void note(Nanoseconds stamp);
    bool goes_on(Nanoseconds stamp) const;
  };
  bool is_partner(Side side, Nanoseconds stamp) const;

  std::array<Stream, 2> streams_;
  std::optional<HandFrame> waiting_;
  Side waiting_side_ = Side::left;
};

}  // namespace mrhi
