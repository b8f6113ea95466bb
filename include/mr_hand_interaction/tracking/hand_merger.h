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
/// has the stamp of a frame of the leading stream: the first that delivers, while it goes on. The hands of
/// the other streams are interpolated at that stamp, so a merged frame waits for their next ones. A stream
/// ends after two of its intervals, or 0.1 s, without a frame. Depends only on the frames.
class HandMerger {
 public:
  enum class Mode : std::uint8_t {
    people,  ///< each stream sees its own hands; ids become unique: id * streams + stream
    fused    ///< all streams see the hands of one person: one hand of a side, with ids 1 (left) and 2 (right)
  };

  /// At least one stream.
  HandMerger(std::size_t streams, Mode mode);

  /// Takes a frame of a stream, and returns the merged frames that it completes, oldest first. A frame that
  /// is not after the previous one restarts its stream.
  std::vector<HandFrame> take(std::size_t stream, const HandFrame& frame);

 private:
  struct Stream {
    std::deque<HandFrame> frames;  ///< newest last
    Nanoseconds interval = 0;      ///< between the last two; 0: not known

    bool goes_on(Nanoseconds now) const;
    /// Hands interpolated at the stamp from the frames around it.
    std::vector<Hand> at(Nanoseconds stamp) const;
  };
  /// One hand of the person that all streams see.
  struct FusedSide {
    std::vector<double> weights;            ///< of the streams, slowly changing
    std::vector<std::optional<Hand>> seen;  ///< by each stream, in the merged frame before
    std::optional<Hand> output;
    Nanoseconds stamp = 0;
    HandVelocity jump;  ///< of points [m], which fades: from a change in which streams see the hand
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

/// Pairs left and right hands of separate streams by their stamps alone, so that a replay repeats the live
/// node. While both streams continue, a frame waits for one of the other side: they are a pair if their
/// stamps differ by at most half the interval of the faster stream, whose frames without a partner are
/// dropped. A stream ends after two of its intervals, or 0.1 s, without a frame.
class HandPairs {
 public:
  /// Takes a frame of one side, and returns the frame that it completes, if any.
  std::optional<HandFrame> take(Side side, const HandFrame& frame);
  /// The frame that still waits at the end of a recording.
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

/// Fills joints that a tracker loses for moments: each moves rigidly with the joints that are in both frames
/// (at least three, not collinear). For trackers that report at most one hand of a side. Depends only on
/// stamps, so that a replay repeats the live node.
class JointGaps {
 public:
  static constexpr Nanoseconds kLongest = 200'000'000;  ///< the default of tracking/hold_time

  /// Fills joints that were seen within kLongest.
  void fill(JointsFrame& frame);

 private:
  static constexpr std::size_t kJoints = 1 + 5 * kFingers;  // the wrist, then finger by finger
  using Points = std::array<std::optional<Vector3>, kJoints>;
  struct Memory {
    Nanoseconds stamp = 0;
    Points points;                            ///< with what was put in
    std::array<Nanoseconds, kJoints> seen{};  ///< when each was last

    void move_on(const Points& now);
    void take(HandJoints& hand, Nanoseconds at);
  };

  std::array<Memory, 2> sides_;
};

}  // namespace mrhi
