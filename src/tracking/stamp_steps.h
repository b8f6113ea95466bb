#pragma once

#include <cstdint>
#include <optional>

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// Takes the steps of a tracker's clock out of its stamps, with the time of receipt as witness. Two frames in
/// a row that are off by the same time, while their receipts go on evenly, prove a step: the second one then
/// continues the stream where its receipt says. The first one keeps its stamp; StampCheck leaves it out.
class StampSteps {
 public:
  struct Verdict {
    Nanoseconds stamp;     ///< without steps
    bool is_step = false;  ///< this frame has proved one
    bool first_was_off =
        false;  ///< the stream's first frame alone was of another clock; nothing is corrected
  };

  /// A frame's stamp, and when it was received, where that is known.
  Verdict take(Nanoseconds stamp, const std::optional<Nanoseconds>& receipt);

 private:
  struct Frame {
    Nanoseconds stamp, receipt;
  };
  Verdict accept(const Frame& frame);

  std::optional<Frame> last_;   // that was accepted, with its own stamp
  std::optional<Frame> off_;    // the frame before, if it was off
  Nanoseconds interval_ = 0;    // between the last two accepted
  Nanoseconds correction_ = 0;  // to add to the stamps
  std::uint64_t accepted_ = 0;
};

}  // namespace mrhi
