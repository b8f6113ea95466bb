// Many elastic spheres in zero gravity: momentum and energy are conserved.
#include <random>

#include "../experiment.h"

namespace mrhi::benchmark {
namespace {

constexpr double kRadius = 0.01, kMass = 0.05, kSpacing = 0.025, kSpeed = 0.5;

class Elastic final : public Experiment {
 public:
  explicit Elastic(int edge) : edge_(edge) {
    std::mt19937 generator(3);
    const auto number = [&generator] { return 2.0 * static_cast<double>(generator()) / 4294967295.0 - 1.0; };
    for (int i = 0; i < edge * edge * edge; ++i) {
      const double x = number(), y = number(), z = number();
      velocities_.emplace_back(kSpeed * x, kSpeed * y, kSpeed * z);
      momentum_ += kMass * velocities_.back();
      scale_ += kMass * velocities_.back().norm();
      energy_ += 0.5 * kMass * velocities_.back().squaredNorm();
    }
  }
  double duration() const override { return 0.5; }

  World world(int) const override {
    World world;
    world.restitution = 1.0;
    world.friction = 0.0;
    for (int i = 0; i < static_cast<int>(velocities_.size()); ++i) {
      const Vector3 place(i % edge_, i / edge_ % edge_, i / (edge_ * edge_));
      world.bodies.push_back(ball(kRadius, kMass, {kSpacing * place, Quaternion::Identity()},
                                  {velocities_[static_cast<std::size_t>(i)], Vector3::Zero()}));
    }
    return world;
  }

  bool observe(int, double t, const Engine& engine) override {
    if (t < duration() - 1e-9) return true;
    Vector3 momentum = Vector3::Zero();
    double energy = 0.0;
    for (std::size_t i = 0; i < velocities_.size(); ++i) {
      const Motion motion = engine.motion(i);
      momentum += kMass * motion.twist.linear;
      energy += 0.5 * kMass * motion.twist.linear.squaredNorm() +
                0.2 * kMass * kRadius * kRadius * motion.twist.angular.squaredNorm();
      if ((motion.twist.linear - velocities_[i]).norm() > 1e-6) ++struck_;
    }
    momentum_error_ = (momentum - momentum_).norm() / scale_;
    energy_error_ = std::abs(energy / energy_ - 1.0);
    return false;
  }
  /// Spheres that pass through each other conserve momentum too: nearly all must have collided.
  std::vector<Measure> measures() const override {
    const bool failed = 2 * struck_ < velocities_.size() || !(energy_error_ < 2.0);
    return {{"_energy", 100.0 * energy_error_, "%", failed},
            {"_momentum", 100.0 * momentum_error_, "%", failed}};
  }

 private:
  int edge_;
  std::vector<Vector3> velocities_;
  Vector3 momentum_ = Vector3::Zero();
  double scale_ = 0.0, energy_ = 0.0, momentum_error_ = 0.0, energy_error_ = 0.0;
  std::size_t struck_ = 0;
};

}  // namespace

void add_elastic_scenes(std::vector<ScenePlan>& scenes) {
  scenes.push_back(
      {"elastic", "elastic", {}, [](bool quick) { return std::make_unique<Elastic>(quick ? 3 : 5); }});
}

}  // namespace mrhi::benchmark
