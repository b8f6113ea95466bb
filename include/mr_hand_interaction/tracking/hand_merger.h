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
/// has ended when two of its intervals, or 0.1 s, have gone by without a frame. Depends on the frames alone.
class HandMerger {
 public:
  enum class Mode : std::uint8_t {
    people,  ///< each stream sees hands of its own; ids are made different: id * streams + stream
    fused    ///< all streams see the hands of one person: one hand of a side, with ids 1 (left) and 2 (right)
  };

  /// At least one stream.
  HandMerger(std::size_t streams, Mode mode);

  /// Merged frames that are complete with this frame of a stream, oldest first. A frame that is not after the
  /// one before it in its stream begins its stream anew.
  std::vector<HandFrame> take(std::size_t stream, const HandFrame& frame);

 private:
  struct Stream {
    std::deque<HandFrame> frames;  ///< newest last
    Nanoseconds interval = 0;      ///< between the last two; 0: not known

    bool goes_on(Nanoseconds now) const;
    /// Hands in the frames on both sides of the stamp, in between.
    std::vector<Hand> at(Nanoseconds stamp) const;
  };
  /// One side of the person that all streams see.
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

/// Joints that a tracker loses for moments stay with their hand: each is moved on as those that are seen
/// before and after have moved together (three, not in one line, must be). For trackers that report at most
/// one hand of a side. By stamps alone, so that a replay does as the live node.
class JointGaps {
 public:
  static constexpr Nanoseconds kLongest = 200'000'000;  ///< as tracking/hold_time ships

  /// Puts in what was seen no longer ago than kLongest.
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
