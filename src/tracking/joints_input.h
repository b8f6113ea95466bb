#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "joint_orders.h"
#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/tracking/hand_pairs.h"
#include "mr_hand_interaction/tracking/joint_gaps.h"
#include "mr_hand_interaction/tracking/joints.h"

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

/// One frame of input, or why it cannot be used.
struct SourceFrame {
  std::optional<HandFrame> frame;
  std::optional<Nanoseconds> arrival;  ///< when it was received, by the receiver's clock, where that is known
  bool waits = false;                  ///< for the other hand's, with which it comes
  bool first_was_off = false;          ///< the frame before the last of its stream was of another clock
  std::string reason;                  ///< kind of refusal, for counting; empty if there is a frame
  std::string detail;                  ///< the particular case
  std::vector<std::string> left_out;   ///< hands of the frame that cannot be used, each with its defect
  /// What was put right in it, by kind, and the particular case.
  std::vector<std::pair<std::string, std::string>> corrected;
};

/// What one message of a tracker says.
struct TrackerFrame {
  std::string stream;                  ///< who sent it, and where to: those of one stream have one clock
  JointsFrame joints;                  ///< in the tracker's own frame and unit; stamp 0: not set
  std::optional<Side> side;            ///< the only one that it has, if those of the other come on their own
  std::optional<Nanoseconds> receipt;  ///< when it was received, where that is known
  bool one_of_a_side = true;           ///< it never has two hands of one side
};

/// The one way from trackers' frames to hands in world, for live nodes, bags and recordings: units, stamps,
/// placeholders, stray joints, gaps, and hands that belong together. Depends on what it is given alone, so
/// that a replay does as the live node.
class JointsInput {
 public:
  static constexpr const char* kJointsLeftOut = "joints left out";
  static constexpr const char* kNoHand = "hands of placeholders";
  static constexpr const char* kStep = "clock steps taken out";
  static constexpr const char* kOrder = "order of joints recognised";
  static constexpr const char* kUnusable = "unusable hand";
  static constexpr const char* kNoStamp = "stamp out of range";
  static const std::vector<const char*>& corrections();

  /// Pose of the tracker in world at a stamp.
  using Device = std::function<Pose(Nanoseconds)>;

  /// `scale`: metres per unit of the tracker's lengths.
  explicit JointsInput(double scale = 1.0) : scale_(scale) {}

  SourceFrame take(TrackerFrame input, const Device& device);
  /// What still waits, at the end of a recording.
  std::optional<HandFrame> rest() { return pairs_.rest(); }

 private:
  struct Stream {
    StampSteps steps;
    std::array<bool, 2> wrist_moves{}, is_placeholder{};  // by side
  };
  void correct(Stream& stream, JointsFrame& joints, SourceFrame& result) const;
  static SourceFrame completed(const JointsFrame& joints, const Device& device, SourceFrame result);

  double scale_;
  std::map<std::string, Stream> streams_;
  JointGaps gaps_;
  HandPairs pairs_;
};

}  // namespace mrhi
