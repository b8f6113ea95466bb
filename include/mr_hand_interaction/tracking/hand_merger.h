#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "mr_hand_interaction/tracking/hand.h"
#include "mr_hand_interaction/tracking/hand_track.h"
#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {

/// Merges the frames of several trackers, in world and stamped by one clock, into one stream. A merged frame
/// has the stamp of the leading stream: the first that delivers frames. Hands of the other streams are
/// interpolated at that stamp, so a merged frame waits for their next frames. A stream ends when two of its
/// intervals, or 0.1 s, pass without a frame. The result depends on the frames alone.
class HandMerger {
 public:
  enum class Mode : std::uint8_t {
    people,  ///< streams see different hands; ids become unique: id * streams + stream
    fused    ///< streams see one person: one hand of each side, with ids 1 (left) and 2 (right)
  };

  /// `streams`: at least 1.
  HandMerger(std::size_t streams, Mode mode);

  /// Returns the merged frames that this frame of a stream completes, oldest first. A frame that is not later
  /// than its predecessor restarts its stream.
  std::vector<HandFrame> take(std::size_t stream, const HandFrame& frame);

 private:
  struct Stream {
    std::deque<HandFrame> frames;  ///< newest last
    Nanoseconds interval = 0;      ///< between the last two; 0: unknown

    bool continues(Nanoseconds now) const;
    /// Hands interpolated between the frames on both sides of the stamp.
    std::vector<Hand> at(Nanoseconds stamp) const;
  };
  /// One hand of a person seen by all streams.
  struct FusedSide {
    std::vector<double> weights;            ///< of the streams; they change slowly
    std::vector<std::optional<Hand>> seen;  ///< by each stream, in the last merged frame
    std::optional<Hand> output;
    Nanoseconds stamp = 0;
    HandVelocity jump;  ///< fading offset of points [m], after a change in the streams that see the hand
    Nanoseconds jumped = 0;
  };
  void take_complete(std::vector<HandFrame>& complete);
  bool is_complete(const HandFrame& leading) const;
  HandFrame merged(const HandFrame& leading);
  std::optional<Hand> fuse(FusedSide& side, Nanoseconds stamp, const std::vector<std::optional<Hand>>& seen);

  Mode mode_;
  std::vector<Stream> streams_;
  std::optional<std::size_t> leader_;
  std::deque<HandFrame> waiting_;  ///< of the leader
  Nanoseconds newest_ = 0;
  std::optional<Nanoseconds> merged_;  ///< stamp of the last merged frame
  std::array<FusedSide, 2> sides_;
};

/// Combines left and right hands from separate streams into frames, by their stamps alone, so a replay equals
/// the live node. While both streams continue, a frame waits for one of the other side. Two frames match if
/// their stamps differ by at most half the interval of the faster stream; its frames without a match are
/// dropped. A stream ends when two of its intervals, or 0.1 s, pass without a frame.
class HandPairs {
 public:
  /// Returns the frame that this one of a side completes, if any.
  std::optional<HandFrame> take(Side side, const HandFrame& frame);
  /// True if the last take() dropped a frame that had waited.
  bool has_dropped() const { return has_dropped_; }
  /// Returns the waiting frame, at the end of a recording.
  std::optional<HandFrame> rest();

 private:
  struct Stream {
    Nanoseconds last = 0, interval = 0;  ///< interval 0: unknown
    void note(Nanoseconds stamp);
    bool continues(Nanoseconds stamp) const;
  };
  bool is_partner(Side side, Nanoseconds stamp) const;

  std::array<Stream, 2> streams_;
  bool has_dropped_ = false;
  std::optional<HandFrame> waiting_;
  Side waiting_side_ = Side::left;
};

/// Fills short gaps of single joints. A missing joint moves with the rigid motion of the joints seen before
/// and now, at least three that are not collinear. For trackers that report at most one hand of a side. Uses
/// stamps alone, so a replay equals the live node.
class JointGaps {
 public:
  static constexpr Nanoseconds kLongest = 200'000'000;  ///< default of tracking/hold_time

  /// Fills joints that were last seen at most kLongest ago.
  void fill(JointsFrame& frame);

 private:
  static constexpr std::size_t kJoints = 1 + 5 * kFingers;  // the wrist, then finger by finger
  using Points = std::array<std::optional<Vector3>, kJoints>;
  struct Memory {
    Nanoseconds stamp = 0;
    Points points;                            ///< including filled ones
    std::array<Nanoseconds, kJoints> seen{};  ///< stamp at which each was last seen

    void move_on(const Points& now);
    void take(HandJoints& hand, Nanoseconds at);
  };

  std::array<Memory, 2> sides_;
};

}  // namespace mrhi
