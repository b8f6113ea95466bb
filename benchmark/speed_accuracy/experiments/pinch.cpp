// Scene (a): a cube held in a pinch while the hand swings, shakes, or is tracked with noise. A rigid cube
// under dry friction would not move in the hand.
#include <memory>
#include <random>

#include "../experiment.h"
#include "displacement.h"
#include "pinch_hand.h"
#include "support/tessellated.h"

namespace mrhi::benchmark {
namespace {

constexpr double kSettled = 0.5;  // [s]
constexpr double kRamp = 0.5;     // duration of the motion's onset [s]
constexpr double kLost = 0.03;    // [m]
constexpr double kDegrees = M_PI / 180.0;

struct Motion3 {
  double amplitude, frequency;  // [m], [Hz]
  bool noisy;
  int further_cubes;
  int squares = 0;            // along an edge of the cube, each of two triangles; 0: a box, no mesh
  double frame_rate = 120.0;  // of the noisy tracker [Hz]
};

/// The same body as a mesh of 12 squares^2 triangles.
BodySpec meshed(BodySpec body, int squares) {
  const Vector3 half = std::get<Box>(body.shape).half_extents;
  body.shape = Mesh{std::make_shared<TriangleMesh>(testing::tessellated_box(half, squares)), ""};
  return body;
}

class Noise {
 public:
  /// Rms per axis [m] of each of `frames` samples.
  Noise(unsigned seed, std::size_t frames, double rms) {
    std::mt19937 generator(seed);
    for (std::size_t i = 0; i < frames; ++i) samples_.push_back(rms * normal3(generator));
  }
  const Vector3& operator[](std::size_t frame) const {
    return samples_[std::min(frame, samples_.size() - 1)];
  }

 private:
  /// Sums of twelve uniform numbers: equal on every machine, unlike std::normal_distribution.
  static Vector3 normal3(std::mt19937& generator) {
    Vector3 v = Vector3::Constant(-6.0);
    for (int i = 0; i < 36; ++i) v[i % 3] += static_cast<double>(generator()) / 4294967296.0;
    return v / std::sqrt(3.0);
  }
  std::vector<Vector3> samples_;
};

class Pinch final : public Experiment {
 public:
  Pinch(const Motion3& motion, double seconds) : motion_(motion), seconds_(kSettled + seconds) {
    const auto frames = static_cast<std::size_t>(seconds_ * motion_.frame_rate) + 2;
    for (unsigned i = 0; i <= PinchHand::kParts; ++i)
      noise_.emplace_back(7 + i, frames, i == 0 ? 3e-4 : 1.5e-4);
  }

  double duration() const override { return seconds_; }

  World world(int) const override {
    World world;
    world.bodies.push_back(box(Vector3::Constant(2.0 * hand_.half), 0.1));
    if (motion_.squares > 0) world.bodies[0] = meshed(world.bodies[0], motion_.squares);
    for (int i = 0; i < motion_.further_cubes; ++i) {
      const Pose pose{Vector3(0.2 * (i % 5), 0.2 * (i / 5), 1.0), Quaternion::Identity()};
      world.bodies.push_back(box(Vector3::Constant(0.05), 0.1, pose));
    }
    world.kinematics = hand_.parts();
    return world;
  }

  void hand(int, double t, std::vector<Pose>& poses) const override {
    for (int finger = 0; finger < PinchHand::kParts; ++finger)
      poses[static_cast<std::size_t>(finger)] = motion_.noisy ? noisy(finger, t) : exact(finger, t);
  }

  bool observe(int, double t, const Engine& engine) override {
    Pose pose = engine.motion(0).pose;
    pose.position -= sway(t);
    lost_ = lost_ || !(pose.position.norm() < kLost);
    if (t >= kSettled - 1e-9) displacement_.add(t, pose);
    return !lost_;
  }

  std::vector<Measure> measures() const override {
    std::vector<Measure> measures{{"", 1e3 * displacement_.greatest(), "mm", lost_}};
    if (motion_.further_cubes > 0) return measures;
    measures.push_back({"_turn", displacement_.greatest_turn() / kDegrees, "deg", lost_});
    measures.push_back({"_jitter", 1e6 * displacement_.jitter(0.025), "um", lost_});
    if (!motion_.noisy) measures.push_back({"_slip", 1e3 * displacement_.last(), "mm", lost_});
    return measures;
  }

 private:
  /// Returns to rest at the start in the last half second.
  Vector3 sway(double t) const {
    const double envelope = smooth(t - kSettled, kRamp) * smooth(seconds_ - 0.25 - t, kRamp);
    const double way = motion_.amplitude * std::sin(2.0 * M_PI * motion_.frequency * (t - kSettled));
    return envelope * way * Vector3(1, 2, 2) / 3.0;
  }
  Pose exact(int finger, double t) const { return hand_.finger(finger, t, sway(t)); }
  Pose sample(int finger, std::size_t frame) const {
    Pose pose = exact(finger, static_cast<double>(frame) / motion_.frame_rate);
    pose.position += noise_[0][frame] + noise_[static_cast<std::size_t>(finger) + 1][frame];
    return pose;
  }
  Pose noisy(int finger, double t) const {
    const auto frame = static_cast<std::size_t>(t * motion_.frame_rate);
    const double part = t * motion_.frame_rate - static_cast<double>(frame);
    Pose pose = sample(finger, frame);
    pose.position += part * (sample(finger, frame + 1).position - pose.position);
    return pose;
  }

  Motion3 motion_;
  double seconds_;
  PinchHand hand_;
  std::vector<Noise> noise_;
  Displacement displacement_;
  bool lost_ = false;
};

/// A pinch held still: any motion is creep.
class Creep final : public Experiment {
 public:
  Creep(double gravity, double seconds) : gravity_(gravity), seconds_(seconds) {}
  double duration() const override { return seconds_; }
  World world(int) const override {
    World world;
    world.gravity = Vector3(0, 0, -gravity_);
    // Nothing supports the cube at first: it falls by some millimetres until the fingers have closed.
    world.bodies.push_back(box(Vector3::Constant(2.0 * hand_.half), 0.1));
    world.kinematics = hand_.parts();
    return world;
  }
  void hand(int, double t, std::vector<Pose>& poses) const override {
    for (int finger = 0; finger < PinchHand::kParts; ++finger) {
      Pose& pose = poses[static_cast<std::size_t>(finger)];
      // Fast enough for the cube to fall little before it is held.
      pose = hand_.finger(finger, 4.0 * t, Vector3::Zero());
    }
  }
  bool observe(int, double t, const Engine& engine) override {
    const Pose pose = engine.motion(0).pose;
    lost_ = lost_ || !(pose.position.norm() < kLost);
    if (t >= kWatched) displacement_.add(t, pose);
    return !lost_;
  }
  std::vector<Measure> measures() const override {
    return {{"", 1e6 * displacement_.last() / (seconds_ - kWatched), "um/s", lost_}};
  }

 private:
  static constexpr double kWatched = 1.0;  // start of observation [s]
  double gravity_, seconds_;
  PinchHand hand_;
  Displacement displacement_;
  bool lost_ = false;
};

}  // namespace

void add_pinch_scenes(std::vector<ScenePlan>& scenes) {
  const auto add = [&scenes](const char* name, const Motion3& motion) {
    scenes.push_back({name, "pinch", {}, [motion](bool quick) {
                        const double full = motion.further_cubes > 0 ? 1.5 : 6.0;
                        return std::make_unique<Pinch>(motion, quick ? std::min(full, 2.0) : full);
                      }});
  };
  add("pinch_swing", {0.1, 0.5, false, 0});
  add("pinch_shake", {0.05, 3.0, false, 0});
  add("pinch_noisy", {0.1, 0.5, true, 0});
  add("pinch_noisy_1khz", {0.1, 0.5, true, 0, 0, 1000.0});
  add("pinch_swing_19_more", {0.1, 0.5, false, 19});
  for (const auto& [name, squares] : {std::pair{"pinch_swing_mesh_972", 9}, {"pinch_swing_mesh_10092", 29}}) {
    add(name, {0.1, 0.5, false, 0, squares});
    scenes.back().steps = {0.001, 1.0 / 120.0};
    scenes.back().budget = 3.0;  // some need milliseconds per step
  }
  const auto creep = [&scenes](const char* name, double gravity) {
    scenes.push_back({name, "creep", {}, [gravity](bool quick) {
                        return std::make_unique<Creep>(gravity, quick ? 2.0 : 6.0);
                      }});
  };
  creep("creep_0g", 0.0);
  creep("creep_1g", 9.81);
}

}  // namespace mrhi::benchmark
