#include "joints_input.h"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <utility>

#include "../math/minimum_jerk.h"
#include "../math/registration.h"
#include "../text/text.h"
#include "mr_hand_interaction/stamp_check.h"
#include "mr_hand_interaction/tracking/hand_track.h"

namespace mrhi {
namespace {

/// Largest difference between the delays of two receipts [ns]. Frames received all at once prove nothing.
constexpr Nanoseconds kMaxJitter = 20'000'000;

bool is_even(Nanoseconds by_stamp, Nanoseconds by_receipt) {
  return by_stamp > 0 && 4 * by_receipt > by_stamp && by_receipt - by_stamp < kMaxJitter + by_stamp;
}

/// Longest gap of a slow stream, in intervals of its last two frames.
constexpr Nanoseconds kMaxIntervals = 4;
/// Inverse of the largest drift between clocks: 1 s in this many seconds.
constexpr Nanoseconds kInverseDrift = 1000;
/// Largest difference between two streams' corrections for one step: the largest delay of a receipt [ns].
constexpr Nanoseconds kSameStepTolerance = 100'000'000;

}  // namespace

/// Receipts that go back belong to a recording that starts again: the state is reset.
StampSteps::Verdict StampSteps::take(Nanoseconds stamp, const std::optional<Nanoseconds>& receipt) {
  if (!receipt || std::abs(stamp) > StampCheck::kLatest || std::abs(*receipt) > StampCheck::kLatest)
    return {stamp + correction_};
  const Frame frame{stamp, *receipt};
  if (last_ && frame.receipt - last_->receipt < -StampCheck::kBack) *this = StampSteps();
  if (!last_) return accept(frame);
  const Nanoseconds since = frame.stamp - last_->stamp;
  const Nanoseconds passed = std::max<Nanoseconds>(0, frame.receipt - last_->receipt);
  const Nanoseconds max_interval =
      std::max({StampCheck::kAhead, kMaxIntervals * interval_, passed + StampCheck::kAhead});
  const bool waited_less = frame.lead() <= lead_ + StampCheck::kAhead;
  if (since > 0 && (since <= max_interval || waited_less)) return accept(frame);
  const std::optional<Frame> before = off_;
  off_ = frame;
  Verdict verdict{stamp + correction_};
  verdict.is_stray = !before && accepted_ > 1 && (since > 0 || since < -StampCheck::kBack);
  if (!before || !is_even(frame.stamp - before->stamp, frame.receipt - before->receipt)) return verdict;
  verdict.stamp = stamp;
  if (accepted_ == 1) {
    verdict.first_was_off = true;
  } else {
    verdict.is_step = true;
    correction_ += last_->stamp + passed - frame.stamp;
  }
  verdict.stamp = accept(frame, true).stamp;
  return verdict;
}

StampSteps::Verdict StampSteps::accept(const Frame& frame, bool restarts) {
  const Nanoseconds passed = last_ ? std::max<Nanoseconds>(0, frame.receipt - last_->receipt) : 0;
  lead_ = last_ && !restarts ? std::max(lead_ - passed / kInverseDrift, frame.lead()) : frame.lead();
  interval_ = last_ && !off_ ? std::min(frame.stamp - last_->stamp, StampCheck::kBack) : 0;
  last_ = frame;
  off_.reset();
  ++accepted_;
  return {frame.stamp + correction_};
}

/// Moves the remembered joints with the hand: x' = to + R (x - from), R the least-squares rotation between
/// the joints that are in both frames. Forgets them if there is none.
void JointGaps::Memory::move_on(const Points& now) {
  std::array<Vector3, kJoints> from, to;
  std::size_t size = 0;
  for (std::size_t i = 0; i < kJoints; ++i) {
    if (!points[i] || !now[i]) continue;
    from[size] = *points[i];
    to[size++] = *now[i];
  }
  const auto motion = registered(from.data(), to.data(), size);
  for (auto& point : points) {
    if (!motion) point.reset();
    if (point) *point = motion->to + motion->rotation * (*point - motion->from);
  }
}

/// Fills a missing joint from its last place, moved frame by frame, until kLongest after it was last seen. A
/// filled joint counts as known in the next frame, but not as seen.
void JointGaps::Memory::take(HandJoints& hand, Nanoseconds at) {
  if (!is_finite(hand)) return;  // it will be refused
  if (at <= stamp || at - stamp > kLongest) points = Points();
  Points now;
  bool gaps = false;
  for (std::size_t i = 0; i < kJoints; ++i) {
    now[i] = joint(hand, i);
    if (now[i]) seen[i] = at;
    gaps = gaps || (points[i] && !now[i]);
  }
  if (gaps) move_on(now);
  for (std::size_t i = 0; i < kJoints; ++i) {
    if (now[i] || at - seen[i] > kLongest) points[i] = now[i];
    joint(hand, i) = points[i];
  }
  stamp = at;
}

void JointGaps::fill(JointsFrame& frame) {
  for (HandJoints& hand : frame.hands) sides_[static_cast<std::size_t>(hand.side)].take(hand, frame.stamp);
}

const std::vector<const char*>& JointsInput::corrections() {
  static const std::vector<const char*> all{kJointsLeftOut, kNoHand, kStep, kOrder, kUnpaired};
  return all;
}

SourceFrame JointsInput::take(TrackerFrame input, const Device& device) {
  SourceFrame result;
  result.arrival = input.receipt;
  JointsFrame& joints = input.joints;
  Stream& stream = streams_[input.stream];
  const bool is_stamped = joints.stamp != 0;
  if (!is_stamped) joints.stamp = input.receipt.value_or(0);
  const StampSteps::Verdict verdict = stream.steps.take(joints.stamp, input.receipt);
  result.first_was_off = verdict.first_was_off;
  if (verdict.is_step)
    result.corrected.emplace_back(
        kStep, text::number(to_seconds(joints.stamp - verdict.stamp)) + " s on " + input.stream);
  joints.stamp = verdict.stamp;
  if (verdict.is_stray && is_stamped) {
    result.reason = kStray;
    result.detail =
        text::number(to_seconds(verdict.stamp - stream.newest)) + " s from the last frame's stamp";
    return result;
  }
  if (verdict.is_step) joints.stamp += share_correction(stream);
  const Nanoseconds since = joints.stamp - stream.taken;
  if (stream.is_burst(joints.stamp)) {
    result.reason = kBurst;
    result.detail = text::number(1e3 * to_seconds(since)) +
                    " ms after another frame; usual: " + text::number(1e3 * to_seconds(stream.interval)) +
                    " ms";
    return result;
  }
  correct(stream, joints, result);
  if (input.one_of_a_side) gaps_.fill(joints);
  result = completed(joints, device, std::move(result));
  if (!result.frame || !input.side) return result;
  result.frame = pairs_.take(*input.side, *result.frame);
  result.waits = !result.frame;
  if (pairs_.has_dropped())
    result.corrected.emplace_back(
        kUnpaired, "none of the other hand at its time; allowed: both hands on one topic, or at one rate");
  return result;
}

/// True for a frame whose stamp is far closer to the last one taken than the stream's frames usually are.
///
/// Frames that a network or a busy machine has delayed arrive together. If they are stamped then, their hands
/// seem many times as fast as they were, and a hand tears itself from what it holds. The first of them alone
/// has a speed that is about right. A stream with slightly uneven stamps loses nothing.
bool JointsInput::Stream::is_burst(Nanoseconds stamp) {
  constexpr Nanoseconds kMinFraction = 3;  // smallest interval: the usual one divided by this
  constexpr Nanoseconds kMeanFrames = 16;
  const Nanoseconds since = stamp - newest;
  newest = stamp;
  const bool continues = since > 0 && since <= StampCheck::kAhead;
  if (continues) interval += interval > 0 ? (since - interval) / kMeanFrames : since;
  if (continues && kMinFraction * (stamp - taken) < interval) return true;
  taken = stamp;
  return false;
}

/// Hands of one tracker share their clock steps: adopts the correction that another stream has found for this
/// step. Returns the change of this frame's stamp.
Nanoseconds JointsInput::share_correction(Stream& stream) {
  const Nanoseconds found = stream.steps.correction();
  for (const auto& [name, other] : streams_) {
    const Nanoseconds known = other.steps.correction();
    if (&other == &stream || known == 0 || std::abs(known - found) > kSameStepTolerance) continue;
    stream.steps.share(known);
    return known - found;
  }
  return 0;
}

/// Removes hands whose joints are all placeholders, and reports when that begins.
void JointsInput::correct(Stream& stream, JointsFrame& joints, SourceFrame& result) const {
  std::vector<HandJoints> hands;
  for (HandJoints& hand : joints.hands) {
    const auto side = static_cast<std::size_t>(hand.side);
    const bool had_joints = known_joints(hand) > 0;
    scale(hand, scale_);
    stream.wrist_moves[side] = stream.wrist_moves[side] || (hand.wrist && *hand.wrist != Vector3::Zero());
    const std::size_t placeholders = drop_placeholders(hand, !stream.wrist_moves[side]);
    const bool is_placeholder = had_joints && known_joints(hand) == 0;
    const std::string name = "hand " + std::to_string(hand.id);
    if (is_placeholder && !stream.is_placeholder[side])
      result.corrected.emplace_back(kNoHand, name + " has placeholders for joints: no hand");
    stream.is_placeholder[side] = is_placeholder;
    if (is_placeholder) continue;
    const std::size_t strays = drop_stray_joints(hand);
    if (placeholders + strays > 0)
      result.corrected.emplace_back(kJointsLeftOut, name + ": " + std::to_string(placeholders) +
                                                        " at a placeholder, " + std::to_string(strays) +
                                                        " at the end of a bone that is too long");
    hands.push_back(std::move(hand));
  }
  joints.hands = std::move(hands);
}

SourceFrame JointsInput::completed(const JointsFrame& joints, const Device& device, SourceFrame result) {
  if (joints.stamp > StampCheck::kLatest) {
    result.reason = kNoStamp;
    result.detail = std::to_string(joints.stamp / 1'000'000'000) + " s";
    return result;
  }
  const Pose pose = joints.hands.empty() ? Pose{} : device(joints.stamp);
  result.frame = complete_frame(joints, pose, result.left_out);
  if (result.frame) return result;
  result.reason = kUnusable;
  result.detail = result.left_out.front();
  result.left_out.clear();
  return result;
}

namespace {

/// Longest interval of a stream that continues, and longest wait for another stream [ns].
constexpr Nanoseconds kMaxWait = 100'000'000;
/// Largest number of frames that wait: of a stream twice as fast as another, for 32 frames of that.
constexpr std::size_t kMaxWaiting = 64;
/// Time in which one stream takes over from another [s].
constexpr double kTransition = 0.2;
/// Largest distance between two streams' views of one hand [m].
constexpr double kSameHandOffset = 0.15;
/// Smallest confidence used as a weight, so that hands without confidence are fused too.
constexpr double kMinConfidence = 0.01;

std::size_t index(Side side) {
  return static_cast<std::size_t>(side);
}

const Hand* hand_of(const std::vector<Hand>& hands, Side side) {
  const Hand* found = nullptr;
  for (const Hand& hand : hands)
    if (hand.side == side && (found == nullptr || hand.confidence > found->confidence)) found = &hand;
  return found;
}

}  // namespace

HandMerger::HandMerger(std::size_t streams, Mode mode) : mode_(mode), streams_(streams) {
  if (streams == 0) throw std::invalid_argument("no stream of hands to merge; allowed: at least one");
  for (FusedSide& side : sides_) {
    side.weights.assign(streams, 0.0);
    side.seen.assign(streams, std::nullopt);
  }
}

bool HandMerger::Stream::continues(Nanoseconds now) const {
  if (frames.empty()) return false;
  const Nanoseconds max_interval = interval > 0 ? std::min(2 * interval, kMaxWait) : kMaxWait;
  return now - frames.back().stamp <= max_interval;
}

std::vector<Hand> HandMerger::Stream::at(Nanoseconds stamp) const {
  const auto after = std::find_if(frames.begin(), frames.end(),
                                  [stamp](const HandFrame& frame) { return frame.stamp >= stamp; });
  if (after == frames.end()) return {};
  if (after->stamp == stamp) return after->hands;
  if (after == frames.begin() || after->stamp - (after - 1)->stamp > kMaxWait) return {};
  const HandFrame& before = *(after - 1);
  const double fraction = to_seconds(stamp - before.stamp) / to_seconds(after->stamp - before.stamp);
  std::vector<Hand> hands;
  for (const Hand& to : after->hands)
    for (const Hand& from : before.hands)
      if (from.id == to.id && from.side == to.side) hands.push_back(blend(from, to, fraction));
  return hands;
}

std::vector<HandFrame> HandMerger::take(std::size_t number, const HandFrame& frame) {
  Stream& stream = streams_.at(number);
  if (!stream.frames.empty() && frame.stamp <= stream.frames.back().stamp) {
    stream = Stream();
    newest_ = frame.stamp;
    if (leader_ == number) waiting_.clear(), merged_.reset();
  }
  if (!stream.frames.empty()) stream.interval = frame.stamp - stream.frames.back().stamp;
  stream.frames.push_back(frame);
  if (stream.frames.size() > kMaxWaiting) stream.frames.pop_front();
  newest_ = std::max(newest_, frame.stamp);
  if (!leader_) leader_ = number;
  if (leader_ == number) waiting_.push_back(frame);
  std::vector<HandFrame> complete;
  take_complete(complete);
  if (leader_ != number && waiting_.empty() && !streams_[*leader_].continues(newest_)) {
    leader_ = number;
    waiting_.push_back(frame);
    take_complete(complete);
  }
  return complete;
}

void HandMerger::take_complete(std::vector<HandFrame>& complete) {
  for (; !waiting_.empty() && (waiting_.size() > kMaxWaiting || is_complete(waiting_.front()));
       waiting_.pop_front()) {
    if (merged_ && waiting_.front().stamp <= *merged_) continue;
    complete.push_back(merged(waiting_.front()));
    merged_ = complete.back().stamp;
  }
}

/// True if the other streams have reached this stamp, or have ended.
bool HandMerger::is_complete(const HandFrame& leading) const {
  return std::all_of(streams_.begin(), streams_.end(), [&](const Stream& stream) {
    return stream.frames.empty() || stream.frames.back().stamp >= leading.stamp || !stream.continues(newest_);
  });
}

HandFrame HandMerger::merged(const HandFrame& leading) {
  HandFrame frame;
  frame.stamp = leading.stamp;
  std::vector<std::vector<Hand>> hands;
  for (std::size_t s = 0; s < streams_.size(); ++s)
    hands.push_back(s == *leader_ ? leading.hands : streams_[s].at(leading.stamp));
  if (mode_ == Mode::people) {
    for (std::size_t s = 0; s < hands.size(); ++s) {
      for (Hand& hand : hands[s]) {
        hand.id = static_cast<std::uint32_t>(hand.id * hands.size() + s);
        frame.hands.push_back(hand);
      }
    }
    return frame;
  }
  for (const Side side : {Side::left, Side::right}) {
    std::vector<std::optional<Hand>> seen(hands.size());
    for (std::size_t s = 0; s < hands.size(); ++s)
      if (const Hand* hand = hand_of(hands[s], side)) seen[s] = *hand;
    if (const auto hand = fuse(sides_[index(side)], leading.stamp, seen)) frame.hands.push_back(*hand);
  }
  return frame;
}

/// Weighted mean of the streams' hands; weights follow the confidence within kTransition. When other streams
/// begin to see the hand, calibration errors would make it jump: it continues from its last pose with the
/// motion of a stream that stays, and the difference fades (minimum jerk).
std::optional<Hand> HandMerger::fuse(FusedSide& side, Nanoseconds stamp,
                                     const std::vector<std::optional<Hand>>& seen) {
  const double passed = side.output ? to_seconds(stamp - side.stamp) : kTransition;
  const bool continues = side.output && passed > 0.0 && passed <= kTransition;
  std::optional<std::size_t> surest;
  for (std::size_t s = 0; s < seen.size(); ++s)
    if (seen[s] && (!surest || seen[s]->confidence > seen[*surest]->confidence)) surest = s;
  if (!surest) {
    side.seen = seen;
    return std::nullopt;
  }
  std::optional<Hand> mean;
  double total = 0.0;
  bool changed = false;
  std::optional<std::size_t> staying;
  for (std::size_t s = 0; s < seen.size(); ++s) {
    const bool agrees =
        seen[s] && (seen[s]->palm.position - seen[*surest]->palm.position).norm() < kSameHandOffset;
    const double confidence = agrees ? std::max(seen[s]->confidence, kMinConfidence) : 0.0;
    changed = changed || agrees != (side.weights[s] > 0.0);
    if (agrees && side.weights[s] > 0.0 && side.seen[s]) staying = s;
    const double rate = continues && side.weights[s] > 0.0 ? std::min(passed / kTransition, 1.0) : 1.0;
    side.weights[s] = agrees ? side.weights[s] + rate * (confidence - side.weights[s]) : 0.0;
    if (!agrees) continue;
    total += side.weights[s];
    mean = mean ? blend(*mean, *seen[s], side.weights[s] / total) : *seen[s];
  }
  Hand hand = *mean;
  hand.id = 1 + static_cast<std::uint32_t>(index(hand.side));
  hand.confidence = seen[*surest]->confidence;
  if (changed || !continues) {
    side.jump = HandVelocity();
    side.jumped = stamp;
    for (std::size_t p = 0; continues && staying && p < kHandPoints; ++p) {
      const Hand &before = *side.seen[*staying], &now = *seen[*staying];
      if (!has_point(hand, p) || !has_point(*side.output, p) || !has_point(before, p) || !has_point(now, p))
        continue;
      side.jump.points[p] =
          hand_point(*side.output, p) + hand_point(now, p) - hand_point(before, p) - hand_point(hand, p);
    }
  }
  const double left = 1.0 - minimum_jerk(std::min(to_seconds(stamp - side.jumped) / kTransition, 1.0));
  for (std::size_t p = 0; p < kHandPoints; ++p)
    if (has_point(hand, p)) hand_point(hand, p) += left * side.jump.points[p];
  side.seen = seen;
  side.output = hand;
  side.stamp = stamp;
  return hand;
}

namespace {

/// Longest interval of a stream that continues [ns]. A busy machine may take only a few frames a second, and
/// would refuse the second hand of each frame for having the stamp of the first.
constexpr Nanoseconds kMaxInterval = 300'000'000;

HandFrame joined(HandFrame first, const HandFrame& second) {
  first.stamp = std::max(first.stamp, second.stamp);
  first.hands.insert(first.hands.end(), second.hands.begin(), second.hands.end());
  return first;
}

}  // namespace

/// A longer or negative interval interrupts the stream: the next frame defines a new one.
void HandPairs::Stream::note(Nanoseconds stamp) {
  const Nanoseconds since = stamp - last;
  interval = since > 0 && since <= kMaxInterval ? since : 0;
  last = stamp;
}

bool HandPairs::Stream::continues(Nanoseconds stamp) const {
  return interval > 0 && std::abs(stamp - last) <= std::min(2 * interval, kMaxInterval);
}

/// With the faster stream's interval T, |difference| <= T / 2: no other frame of that stream is nearer. Both
/// sides are doubled, as stamps are integers.
bool HandPairs::is_partner(Side side, Nanoseconds stamp) const {
  if (!waiting_ || waiting_side_ == side) return false;
  Nanoseconds interval = kMaxInterval;
  for (const Stream& stream : streams_)
    if (stream.interval > 0) interval = std::min(interval, stream.interval);
  return 2 * std::abs(stamp - waiting_->stamp) <= interval;
}

/// A frame waits for one of the other side only while that stream continues. A frame that finds no partner is
/// dropped, as stamps must not decrease.
std::optional<HandFrame> HandPairs::take(Side side, const HandFrame& frame) {
  streams_[index(side)].note(frame.stamp);
  has_dropped_ = false;
  if (is_partner(side, frame.stamp)) {
    const HandFrame other = *std::exchange(waiting_, std::nullopt);
    return side == Side::left ? joined(frame, other) : joined(other, frame);
  }
  has_dropped_ = waiting_.has_value();
  waiting_.reset();
  if (!streams_[1 - index(side)].continues(frame.stamp)) return frame;
  waiting_ = frame;
  waiting_side_ = side;
  return std::nullopt;
}

std::optional<HandFrame> HandPairs::rest() {
  return std::exchange(waiting_, std::nullopt);
}

}  // namespace mrhi
