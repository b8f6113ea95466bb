// Gravity on a fixture: sliding to a stop, bouncing without loss, a stable stack.
#include "../experiment.h"

namespace mrhi::benchmark {
namespace {

constexpr double kGravity = 9.81;  // [m/s^2]
constexpr double kCube = 0.05;     // edge [m]

/// A cube slides over the floor in several directions and stops after v^2 / (2 mu g).
class Sliding final : public Experiment {
 public:
  int trials() const override { return 4; }
  double duration() const override { return 0.6; }
  World world(int trial) const override {
    World world;
    world.gravity = Vector3(0, 0, -kGravity);
    world.friction = kFriction;
    world.bodies.push_back(box(Vector3::Constant(kCube), 0.1,
                               {Vector3(0, 0, 0.5 * kCube), Quaternion::Identity()},
                               {kSpeed * direction(trial), Vector3::Zero()}));
    world.bodies.push_back(floor_slab());
    return world;
  }
  bool observe(int trial, double t, const Engine& engine) override {
    const Vector3 p = engine.motion(0).pose.position;
    lost_ = lost_ || !(std::abs(p.z() - 0.5 * kCube) < 0.5 * kCube);
    if (t < duration() - 1e-9) return !lost_;
    const double exact = kSpeed * kSpeed / (2.0 * kFriction * kGravity);
    const double error = (p - Vector3(0, 0, p.z()) - exact * direction(trial)).norm() / exact;
    squares_ += error * error;
    return false;
  }
  std::vector<Measure> measures() const override {
    return {{"", 100.0 * std::sqrt(squares_ / trials()), "% of the way", lost_}};
  }

 private:
  static constexpr double kSpeed = 1.0, kFriction = 0.5;
  static Vector3 direction(int trial) {
    const double angle = trial * M_PI / 12.0;
    return {std::cos(angle), std::sin(angle), 0.0};
  }
  double squares_ = 0.0;
  bool lost_ = false;
};

/// A ball of restitution 1 falls from 0.5 m and conserves its energy.
class Bouncing final : public Experiment {
 public:
  explicit Bouncing(double seconds) : seconds_(seconds) {}
  double duration() const override { return seconds_; }
  World world(int) const override {
    World world;
    world.gravity = Vector3(0, 0, -kGravity);
    world.restitution = 1.0;
    world.friction = 0.0;
    world.bodies.push_back(ball(kRadius, 0.1, {Vector3(0, 0, kRadius + kHeight), Quaternion::Identity()}));
    world.bodies.push_back(floor_slab());
    return world;
  }
  /// In the air only: during compliant contact part of the energy is in the spring.
  bool observe(int, double, const Engine& engine) override {
    const Motion motion = engine.motion(0);
    const double height = motion.pose.position.z() - kRadius;
    lost_ = lost_ || !(height > -kRadius && height < 100.0);
    ++samples_;
    if (height < 0.01) {
      ++low_;
      return !lost_;
    }
    const double energy = kGravity * height + 0.5 * motion.twist.linear.squaredNorm();
    const double error = energy / (kGravity * kHeight) - 1.0;
    squares_ += error * error;
    return !lost_;
  }
  /// A ball at rest on the floor instead of bouncing has failed.
  std::vector<Measure> measures() const override {
    const int high = samples_ - low_;
    return {
        {"", high > 0 ? 100.0 * std::sqrt(squares_ / high) : 100.0, "% of the energy", lost_ || high < low_}};
  }

 private:
  static constexpr double kRadius = 0.025, kHeight = 0.5;
  double seconds_;
  double squares_ = 0.0;
  int samples_ = 0, low_ = 0;
  bool lost_ = false;
};

/// Three cubes, one on the other.
class Stack final : public Experiment {
 public:
  explicit Stack(double seconds) : seconds_(seconds) {}
  double duration() const override { return seconds_; }
  World world(int) const override {
    World world;
    world.gravity = Vector3(0, 0, -kGravity);
    for (int i = 0; i < kCubes; ++i) world.bodies.push_back(box(Vector3::Constant(kCube), 0.1, start(i)));
    world.bodies.push_back(floor_slab());
    return world;
  }
  bool observe(int, double t, const Engine& engine) override {
    double off = 0.0, moved = 0.0;
    for (int i = 0; i < kCubes; ++i) {
      const auto body = static_cast<std::size_t>(i);
      const Vector3 p = engine.motion(body).pose.position;
      if (!p.allFinite()) fallen_ = true;
      if (t < kSettled) settled_[i] = p;
      off = std::max(off, (p - start(i).position).norm());
      moved = std::max(moved, (p - settled_[i]).norm());
    }
    fallen_ = fallen_ || off > 0.5 * kCube;
    off_ = off;
    rate_ = t > kSettled ? moved / (t - kSettled) : 0.0;
    return !fallen_;
  }
  std::vector<Measure> measures() const override {
    return {{"", 1e3 * off_, "mm", fallen_}, {"_creep", 1e6 * rate_, "um/s", fallen_}};
  }

 private:
  static constexpr int kCubes = 3;
  static constexpr double kSettled = 1.0;  // [s]
  static Pose start(int i) { return {Vector3(0, 0, kCube * (i + 0.5)), Quaternion::Identity()}; }
  double seconds_;
  Vector3 settled_[kCubes];
  double off_ = 0.0, rate_ = 0.0;
  bool fallen_ = false;
};

}  // namespace

void add_gravity_scenes(std::vector<ScenePlan>& scenes) {
  scenes.push_back({"sliding", "sliding", {}, [](bool) { return std::make_unique<Sliding>(); }});
  scenes.push_back({"bouncing", "bouncing", {}, [](bool quick) {
                      return std::make_unique<Bouncing>(quick ? 2.0 : 10.0);
                    }});
  scenes.push_back(
      {"stack", "stack", {}, [](bool quick) { return std::make_unique<Stack>(quick ? 2.0 : 5.0); }});
}

}  // namespace mrhi::benchmark
