#include "takes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "mr_hand_interaction/replay/recording_csv.h"
#include "mr_hand_interaction/synthetic/scripted_motion.h"
#include "mr_hand_interaction/synthetic/synthetic_hand.h"
#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi::filter_benchmark {
namespace {

constexpr double kLongestGap = 0.1;                 // within a take [s]
constexpr std::size_t kFewestFrames = 30;           // minimum of a take
constexpr double kReferenceWidth = 0.05;            // passes frequencies below 14 Hz [s]
constexpr double kStill = 0.02, kMoving = 0.1;      // [m/s]
constexpr double kStillFor = 0.1, kSettling = 0.1;  // before and after; from a take's beginning [s]

/// A take while it is being read.
struct Recorded {
  std::vector<double> times;
  std::vector<Hand> clean, input;
};

double fastest_joint(const Hand& from, const Hand& to, double seconds) {
  double fastest = 0.0;
  for (std::size_t c = 0; c < kPhalanges; ++c) {
    const Capsule &a = from.capsules[c], &b = to.capsules[c];
    if (a.radius > 0.0 && b.radius > 0.0) fastest = std::max(fastest, (a.end - b.end).norm());
  }
  return fastest / seconds;
}

bool goes_on(const Recorded& take, double time, const Hand& hand) {
  const double elapsed = time - take.times.back();
  return elapsed <= kLongestGap &&
         fastest_joint(take.clean.back(), hand, elapsed) <= TrackingConfiguration().max_speed;
}

std::vector<Recorded> read_takes(const std::string& file, std::uint64_t seed, bool with_noise) {
  std::map<std::tuple<std::uint32_t, Side>, Recorded> running;
  std::vector<Recorded> done;
  TrackingNoise noise(with_noise ? 1.0 : 0.0, seed);
  std::vector<std::string> defects;
  for (const JointsFrame& joints : read_recording_csv(file)) {
    JointsFrame disturbed = joints;
    noise.apply(disturbed);
    const auto clean = complete_frame(joints, default_device_mount(), defects);
    const auto input = complete_frame(disturbed, default_device_mount(), defects);
    if (!clean || !input || clean->hands.size() != input->hands.size()) continue;
    for (std::size_t i = 0; i < clean->hands.size(); ++i) {
      const Hand& hand = clean->hands[i];
      const double time = to_seconds(joints.stamp);
      Recorded& take = running[{hand.id, hand.side}];
      if (!take.times.empty() && time <= take.times.back()) continue;
      if (!take.times.empty() && !goes_on(take, time, hand)) {
        done.push_back(std::move(take));
        take = Recorded();
      }
      take.times.push_back(time);
      take.clean.push_back(hand);
      take.input.push_back(input->hands[i]);
    }
  }
  for (auto& [key, take] : running) done.push_back(std::move(take));
  return done;
}

Joints joints_of(const std::vector<Hand>& hands) {
  Joints joints;
  for (int c = 0; c < kPhalanges; ++c) {
    if (!std::all_of(hands.begin(), hands.end(), [c](const Hand& hand) { return hand.has(c); })) continue;
    const auto capsule = static_cast<std::size_t>(c);
    const std::size_t place = joints.capsules.size();
    if (bone_of(c) > 0 && place > 0 && joints.capsules.back() == capsule - 1)
      joints.bones.emplace_back(place - 1, place);
    if (bone_of(c) == kBonesPerFinger - 1) joints.tips.push_back(place);
    joints.capsules.push_back(capsule);
  }
  return joints;
}

std::vector<Doing> doing_of(const std::vector<double>& times, const Eigen::VectorXd& speed) {
  std::vector<Doing> doing(times.size(), Doing::neither);
  double last_fast = -kStillFor, next_fast = times.back() + 2.0 * kStillFor;
  std::vector<bool> calm(times.size(), true);
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (speed[static_cast<Eigen::Index>(i)] >= kStill) last_fast = times[i];
    calm[i] = times[i] - last_fast > kStillFor;
  }
  for (std::size_t i = times.size(); i-- > 0;) {
    if (speed[static_cast<Eigen::Index>(i)] >= kStill) next_fast = times[i];
    calm[i] = calm[i] && next_fast - times[i] > kStillFor;
  }
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (times[i] - times.front() < kSettling) continue;
    if (calm[i]) doing[i] = Doing::still;
    if (speed[static_cast<Eigen::Index>(i)] > kMoving) doing[i] = Doing::moving;
  }
  return doing;
}

Take take_of(Recorded&& recorded, bool with_noise) {
  Take take;
  take.times = std::move(recorded.times);
  take.input = std::move(recorded.input);
  take.joints = joints_of(recorded.clean);
  const Paths clean = paths_of(recorded.clean, take.joints);
  const Smoothed smooth = smoothed(take.times, clean, kReferenceWidth);
  take.reference = with_noise ? clean : smooth.positions;
  for (std::size_t joint = 0; joint < take.joints.capsules.size(); ++joint) {
    const auto column = static_cast<Eigen::Index>(3 * joint);
    take.doing.push_back(doing_of(take.times, smooth.velocities.middleCols(column, 3).rowwise().norm()));
  }
  return take;
}

}  // namespace

double Take::frame_rate() const {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < times.size(); ++i) intervals.push_back(times[i] - times[i - 1]);
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return 1.0 / *middle;
}

Paths paths_of(const std::vector<Hand>& hands, const Joints& joints) {
  Paths paths(static_cast<Eigen::Index>(hands.size()), static_cast<Eigen::Index>(3 * joints.capsules.size()));
  for (std::size_t frame = 0; frame < hands.size(); ++frame) {
    for (std::size_t joint = 0; joint < joints.capsules.size(); ++joint) {
      paths.block<1, 3>(static_cast<Eigen::Index>(frame), static_cast<Eigen::Index>(3 * joint)) =
          hands[frame].capsules[joints.capsules[joint]].end;
    }
  }
  return paths;
}

std::vector<Take> load_takes(const std::vector<std::string>& files, bool with_noise) {
  std::vector<Take> takes;
  for (std::size_t i = 0; i < files.size(); ++i) {
    for (Recorded& recorded : read_takes(files[i], i + 1, with_noise)) {
      if (recorded.times.size() >= kFewestFrames) takes.push_back(take_of(std::move(recorded), with_noise));
    }
  }
  return takes;
}

}  // namespace mrhi::filter_benchmark
