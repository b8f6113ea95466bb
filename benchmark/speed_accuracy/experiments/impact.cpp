// Scene (c): a phalanx hits a cube, and a thin plate. Newton's law gives the speed after a central impact by
// a driven hand: (1 + e) times the hand's, without spin.
#include "../experiment.h"

namespace mrhi::benchmark {
namespace {

constexpr double kSpeed = 3.0;  // [m/s]
constexpr int kPhases = 25;     // phases of the impact within a step and a 120 Hz frame

class Blow : public Experiment {
 public:
  Blow(const Vector3& size, double restitution) : size_(size), restitution_(restitution) {}
  int trials() const override { return kPhases; }
  double duration() const override { return 0.12; }

  World world(int) const override {
    World world;
    world.restitution = restitution_;
    world.bodies.push_back(box(size_, 0.05));
    world.kinematics.push_back({{{Vector3(0, -0.0125, 0), Vector3(0, 0.0125, 0), 0.008}}, {}});
    return world;
  }

  /// Starts 0.1 m away, so that engines that derive velocities from poses have the right one in time.
  void hand(int trial, double t, std::vector<Pose>& poses) const override {
    const double first_gap = 0.1 + kSpeed / 60.0 * trial / kPhases;
    const double x = 0.5 * size_.x() + 0.008 + first_gap - kSpeed * std::min(t, stop(trial));
    poses[0] = {Vector3(x, 0, 0), Quaternion::Identity()};
  }

  bool observe(int trial, double t, const Engine& engine) override {
    const Motion motion = engine.motion(0);
    if (t < duration() - 1e-9 && motion.twist.linear.allFinite()) {
      last_ = motion;
      return true;
    }
    note(trial, motion);
    return false;
  }

 protected:
  virtual void note(int trial, const Motion& motion) = 0;

 private:
  /// The hand stops 0.1 m after first touch: two of the longest steps later.
  double stop(int trial) const { return (0.2 + kSpeed / 60.0 * trial / kPhases) / kSpeed; }

  Vector3 size_;
  double restitution_;
  Motion last_;
};

class Slap final : public Blow {
 public:
  Slap() : Blow(Vector3::Constant(0.05), 0.5) {}
  std::vector<Measure> measures() const override {
    return {{"_speed", 100.0 * std::sqrt(squares_ / kPhases), "%", missed_},
            {"_spin", std::sqrt(spins_ / kPhases), "rad/s", missed_}};
  }

 private:
  void note(int, const Motion& motion) override {
    const double error = -motion.twist.linear.x() / (1.5 * kSpeed) - 1.0;
    missed_ = missed_ || !(std::abs(error) < 0.9);
    squares_ += error * error;
    spins_ += motion.twist.angular.squaredNorm();
  }
  double squares_ = 0.0, spins_ = 0.0;
  bool missed_ = false;
};

class Plate final : public Blow {
 public:
  Plate() : Blow(Vector3(0.005, 0.1, 0.1), 0.0) {}
  std::vector<Measure> measures() const override {
    return {{"", 100.0 * wrong_ / kPhases, "% of plates", wrong_ == kPhases}};
  }

 private:
  void note(int, const Motion& motion) override {
    const double error = -motion.twist.linear.x() / kSpeed - 1.0;
    if (!(std::abs(error) < 0.1)) ++wrong_;
  }
  int wrong_ = 0;
};

}  // namespace

void add_impact_scenes(std::vector<ScenePlan>& scenes) {
  scenes.push_back({"slap", "impact", {}, [](bool) { return std::make_unique<Slap>(); }});
  scenes.push_back({"plate", "impact", {}, [](bool) { return std::make_unique<Plate>(); }});
}

}  // namespace mrhi::benchmark
