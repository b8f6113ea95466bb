#include "take.h"

#include <algorithm>
#include <cmath>

#include "mr_hand_interaction/synthetic/random.h"

namespace mrhi::real_grasps {
namespace {

using Point = std::optional<Vector3>;

Point between(const Point& from, const Point& to, double part) {
  return from && to ? Point(*from + part * (*to - *from)) : std::nullopt;
}

HandJoints between(const HandJoints& from, const HandJoints& to, double part) {
  HandJoints hand = from;
  hand.palm_centre = between(from.palm_centre, to.palm_centre, part);
  hand.wrist = between(from.wrist, to.wrist, part);
  for (std::size_t f = 0; f < kFingers; ++f)
    for (std::size_t j = 0; j < 5; ++j) hand.joints[f][j] = between(from.joints[f][j], to.joints[f][j], part);
  return hand;
}

/// Hands that both frames have.
JointsFrame between(const JointsFrame& from, const JointsFrame& to, Nanoseconds stamp) {
  JointsFrame frame;
  frame.stamp = stamp;
  const double part = to_seconds(stamp - from.stamp) / to_seconds(to.stamp - from.stamp);
  for (const HandJoints& hand : from.hands) {
    for (const HandJoints& next : to.hands)
      if (next.id == hand.id) frame.hands.push_back(between(hand, next, part));
  }
  return frame;
}

std::vector<JointsFrame> resampled(const std::vector<JointsFrame>& frames, double rate) {
  std::vector<JointsFrame> result;
  const auto period = static_cast<Nanoseconds>(std::llround(1e9 / rate));
  Nanoseconds stamp = frames.front().stamp;
  for (std::size_t next = 1; next < frames.size(); ++next) {
    if (frames[next].stamp <= frames[next - 1].stamp) continue;
    for (; stamp <= frames[next].stamp; stamp += period)
      result.push_back(between(frames[next - 1], frames[next], stamp));
  }
  return result;
}

void add_noise(HandJoints& hand, double noise, Random& random) {
  if (hand.palm_centre) *hand.palm_centre += random.gaussian_vector(noise);
  if (hand.wrist) *hand.wrist += random.gaussian_vector(noise);
  const bool empty_metacarpal = hand.joints[0][0] && hand.joints[0][0] == hand.joints[0][1];
  for (auto& finger : hand.joints)
    for (auto& joint : finger)
      if (joint) *joint += random.gaussian_vector(noise);
  if (empty_metacarpal) hand.joints[0][0] = hand.joints[0][1];  // as Leap has the thumb's
}

}  // namespace

std::vector<JointsFrame> disturbed(const std::vector<JointsFrame>& frames, std::size_t first,
                                   std::size_t last, const Disturbance& disturbance) {
  const auto at = [&](std::size_t i) { return frames.begin() + static_cast<std::ptrdiff_t>(i); };
  std::vector<JointsFrame> result(at(first), at(last + 1));
  if (disturbance.rate) result = resampled(result, *disturbance.rate);
  if (disturbance.noise == 0.0) return result;
  Random random(disturbance.seed);
  for (JointsFrame& frame : result)
    for (HandJoints& hand : frame.hands) add_noise(hand, disturbance.noise, random);
  return result;
}

}  // namespace mrhi::real_grasps
