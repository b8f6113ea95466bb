#include "joints_input.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "../math/registration.h"
#include "../text/text.h"
#include "joint_orders.h"
#include "mr_hand_interaction/stamp_check.h"
#include "mr_hand_interaction/tracking/joint_gaps.h"

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

/// All of them, as those that are in both have. x' = to + R (x - from) with the rotation R between the joints
/// that are in both (least squares, without their scale). Without one what was known is forgotten.
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

/// A joint is put in from its last place, moved on frame by frame, up to kLongest after it was seen itself:
/// what has been put in counts as known for the next frame, but not as seen.
void JointGaps::Memory::take(HandJoints& hand, Nanoseconds at) {
  for (std::size_t i = 0; i < kJoints; ++i)
    if (joint(hand, i) && !joint(hand, i)->allFinite()) return;  // it will be refused
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
  static const std::vector<const char*> all{kJointsLeftOut, kNoHand, kStep, kOrder};
  return all;
}

SourceFrame JointsInput::take(TrackerFrame input, const Device& device) {
  SourceFrame result;
  result.arrival = input.receipt;
  JointsFrame& joints = input.joints;
  Stream& stream = streams_[input.stream];
  if (joints.stamp == 0) joints.stamp = input.receipt.value_or(0);
  const StampSteps::Verdict verdict = stream.steps.take(joints.stamp, input.receipt);
  result.first_was_off = verdict.first_was_off;
  if (verdict.is_step)
    result.corrected.emplace_back(
        kStep, text::number(to_seconds(joints.stamp - verdict.stamp)) + " s on " + input.stream);
  joints.stamp = verdict.stamp;
  correct(stream, joints, result);
  if (input.one_of_a_side) gaps_.fill(joints);
  result = completed(joints, device, std::move(result));
  if (!result.frame || !input.side) return result;
  result.frame = pairs_.take(*input.side, *result.frame);
  result.waits = !result.frame;
  return result;
}

/// A hand whose joints are all placeholders is none; it is reported when it becomes one.
void JointsInput::correct(Stream& stream, JointsFrame& joints, SourceFrame& result) const {
  std::vector<HandJoints> hands;
  for (HandJoints& hand : joints.hands) {
    const auto side = static_cast<std::size_t>(hand.side);
    const bool had_joints = has_joints(hand);
    scale(hand, scale_);
    stream.wrist_moves[side] = stream.wrist_moves[side] || (hand.wrist && *hand.wrist != Vector3::Zero());
    const std::size_t placeholders = drop_placeholders(hand, !stream.wrist_moves[side]);
    const bool is_there = has_joints(hand);
    const std::string name = "hand " + std::to_string(hand.id);
    if (had_joints && !is_there && !stream.is_placeholder[side])
      result.corrected.emplace_back(kNoHand, name + " has placeholders for joints: no hand");
    stream.is_placeholder[side] = had_joints && !is_there;
    if (had_joints && !is_there) continue;
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

}  // namespace mrhi
