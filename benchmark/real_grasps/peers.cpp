#include "contenders.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "mr_hand_interaction/response/contact_model.h"
#include "mr_hand_interaction/simulation.h"
#include "recording.h"

namespace mrhi::real_grasps {
namespace {

struct Sample {
  double time;
  Hand hand;
  std::array<Quaternion, kCapsules> turns{};  ///< of the capsules: z along them, without spin about them
};

/// The hand after our filter, in a scene without bodies, while it is tracked.
std::vector<Sample> filtered_hand(const std::vector<JointsFrame>& frames, const Configuration& configuration,
                                  std::uint32_t id) {
  Simulation tracker(Scene{}, configuration);
  std::vector<Sample> samples;
  std::vector<std::string> left_out;
  for (const JointsFrame& joints : frames) {
    const auto frame = complete_frame(joints, device_mount(), left_out);
    if (!frame || tracker.advance(*frame) != Rejection::none) continue;
    const auto& hands = tracker.result().tracked;
    const auto hand = std::find_if(hands.begin(), hands.end(), [id](const Hand& h) { return h.id == id; });
    if (hand == hands.end()) break;
    samples.push_back({to_seconds(frame->stamp), *hand, {}});
  }
  return samples;
}

Vector3 along(const Capsule& capsule) {
  return capsule.end - capsule.start;
}

/// Rotates each capsule from sample to sample by the shortest rotation.
void add_turns(std::vector<Sample>& samples) {
  for (std::size_t c = 0; c < kCapsules; ++c) {
    Vector3 last = Vector3::UnitZ();
    Quaternion turn = Quaternion::Identity();
    for (Sample& sample : samples) {
      const Vector3 next = along(sample.hand.capsules[c]);
      if (!next.isZero()) turn = (Quaternion::FromTwoVectors(last, next) * turn).normalized(), last = next;
      sample.turns[c] = turn;
    }
  }
}

/// A hand's capsules as rigid parts of their mean lengths.
class Parts {
 public:
  explicit Parts(const std::vector<Sample>& samples) : samples_(samples) {
    for (std::size_t c = 0; c < kCapsules; ++c)
      if (samples.front().hand.has(static_cast<int>(c))) used_.push_back(c);
  }

  std::size_t size() const { return used_.size(); }
  std::size_t finger(std::size_t part) const {
    return static_cast<std::size_t>(finger_of(static_cast<int>(used_[part])));
  }

  benchmark::KinematicSpec spec(std::size_t part) const {
    double length = 0.0;
    for (const Sample& sample : samples_) {
      const Capsule& capsule = sample.hand.capsules[used_[part]];
      length += along(capsule).norm() / static_cast<double>(samples_.size());
    }
    const Vector3 half(0, 0, 0.5 * length);
    return {{{-half, half, samples_.front().hand.capsules[used_[part]].radius}}, pose(part, 1, 0.0)};
  }

  /// Interpolates at the fraction `share` from the sample before `next` to it.
  Pose pose(std::size_t part, std::size_t next, double share) const {
    const std::size_t c = used_[part];
    const Capsule &from = samples_[next - 1].hand.capsules[c], &to = samples_[next].hand.capsules[c];
    const Vector3 axis = along(from) + share * (along(to) - along(from));
    const Quaternion turn = Quaternion::FromTwoVectors(along(from), axis) * samples_[next - 1].turns[c];
    return {from.centre() + share * (to.centre() - from.centre()), turn.normalized()};
  }

 private:
  const std::vector<Sample>& samples_;
  std::vector<std::size_t> used_;
};

benchmark::World world_of(const Row& row, const Pose& place, const Parts& parts, const Material& material) {
  benchmark::World world;
  world.friction = material.static_friction;
  world.restitution = material.restitution;
  world.bodies.push_back(row.sphere ? benchmark::ball(0.5 * row.size, row.mass, place)
                                    : benchmark::box(Vector3::Constant(row.size), row.mass, place));
  for (std::size_t i = 0; i < parts.size(); ++i) world.kinematics.push_back(parts.spec(i));
  return world;
}

void look(const benchmark::Engine& engine, const Parts& parts, double time, Playback& playback) {
  std::array<double, kFingers + 1> sums{};
  for (std::size_t i = 0; i < parts.size(); ++i) sums[parts.finger(i)] += engine.pressing(i);
  const benchmark::Motion motion = engine.motion(0);
  if (!motion.pose.position.allFinite()) throw std::runtime_error("not a number");
  Moment moment{time, motion.pose.position, motion.twist.linear};
  for (const double sum : sums) {
    if (!(sum > 0.0)) continue;
    moment.loaded = true;
    playback.forces.push_back(sum);
  }
  playback.moments.push_back(moment);
}

}  // namespace

Playback play_peer(const std::vector<JointsFrame>& frames, const Closing& closing, const Row& row,
                   const Configuration& configuration, const benchmark::EngineMaker& maker,
                   const std::string& setting) {
  using Clock = std::chrono::steady_clock;
  std::vector<Sample> samples = filtered_hand(frames, configuration, closing.hand);
  if (samples.size() < 2) return {};
  add_turns(samples);
  const Parts parts(samples);
  const double step = configuration.step;
  const auto engine =
      maker.make(setting, world_of(row, closing.place, parts, default_material(configuration)), step);
  if (!engine) throw std::runtime_error("the engine has no means for this world");
  engine->watch_forces();
  Playback playback;
  std::vector<Pose> now(parts.size()), next(parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) now[i] = parts.pose(i, 1, 0.0);
  double time = samples.front().time;
  for (std::size_t k = 1; k < samples.size(); ++k) {
    double used = 0.0;
    while (time + step <= samples[k].time + 1e-9) {
      time += step;
      const double share = 1.0 - (samples[k].time - time) / (samples[k].time - samples[k - 1].time);
      for (std::size_t i = 0; i < parts.size(); ++i) {
        next[i] = parts.pose(i, k, share);
        engine->move(i, now[i], next[i]);
      }
      engine->before_step();
      const auto begin = Clock::now();
      engine->step();
      used += std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
      engine->after_step();
      now.swap(next);
    }
    playback.frame_times.push_back(used);
    look(*engine, parts, samples[k].time, playback);
  }
  return playback;
}

}  // namespace mrhi::real_grasps
