#include "joints_input.h"

#include <algorithm>
#include <utility>

#include "../text/text.h"
#include "joint_check.h"
#include "mr_hand_interaction/stamp_check.h"

namespace mrhi {

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
