// Scene (b): free rotation about the intermediate axis. Angular momentum and energy are constant; the body
// flips with a period given by elliptic integrals.
#include "../experiment.h"

namespace mrhi::benchmark {
namespace {

const Vector3 kInertia(1e-4, 2e-4, 3e-4);  // [kg m^2]
const Vector3 kSpin(0.1, 10.0, 0.1);       // [rad/s]

/// Complete elliptic integral of the first kind of parameter m, by the arithmetic-geometric mean.
double elliptic_k(double m) {
  double a = 1.0, b = std::sqrt(1.0 - m);
  while (std::abs(a - b) > 1e-15 * a) {
    const double mean = 0.5 * (a + b);
    b = std::sqrt(a * b);
    a = mean;
  }
  return M_PI / (2.0 * a);
}

/// Time between two reversals of the spin about the intermediate axis (Landau & Lifshitz, Mechanics, 37).
double flip_period() {
  const Vector3& i = kInertia;
  const double twice_energy = kSpin.dot(i.cwiseProduct(kSpin)), l2 = i.cwiseProduct(kSpin).squaredNorm();
  double first = i.x(), last = i.z();
  if (l2 <= twice_energy * i.y()) std::swap(first, last);
  const double rate = std::sqrt((last - i.y()) * (l2 - twice_energy * first) / (first * i.y() * last));
  const double m =
      (i.y() - first) * (twice_energy * last - l2) / ((last - i.y()) * (l2 - twice_energy * first));
  return 2.0 * elliptic_k(m) / rate;
}

class FreeRotation final : public Experiment {
 public:
  explicit FreeRotation(double seconds) : seconds_(seconds) {}
  double duration() const override { return seconds_; }

  World world(int) const override {
    World world;
    BodySpec body = box(Vector3(0.05, 0.04, 0.03), 0.1);
    body.inertia = kInertia;
    body.twist.angular = kSpin;
    world.bodies.push_back(body);
    return world;
  }

  bool observe(int, double t, const Engine& engine) override {
    const Motion motion = engine.motion(0);
    const Vector3 spin = motion.pose.orientation.conjugate() * motion.twist.angular;
    const Vector3 momentum = motion.pose.orientation * kInertia.cwiseProduct(spin);
    const Vector3 start = kInertia.cwiseProduct(kSpin);
    momentum_error_ = std::max(momentum_error_, (momentum - start).norm() / start.norm());
    const double energy = spin.dot(kInertia.cwiseProduct(spin)), before = kSpin.dot(start);
    energy_error_ = std::max(energy_error_, std::abs(energy / before - 1.0));
    broken_ = broken_ || !spin.allFinite() || spin.norm() > 1e3;
    count_flip(t, spin.y());
    return !broken_;
  }

  std::vector<Measure> measures() const override {
    const double exact = flip_period();
    const double period = flips_ > 1 ? (last_flip_ - first_flip_) / (flips_ - 1) : 0.0;
    return {{"_momentum", 100.0 * momentum_error_, "%", broken_},
            {"_energy", 100.0 * energy_error_, "%", broken_},
            {"_flip_period", 100.0 * std::abs(period / exact - 1.0), "%", broken_ || flips_ < 2}};
  }

 private:
  void count_flip(double t, double spin) {
    if (before_ * spin < 0.0) {
      const double time = last_time_ + (t - last_time_) * before_ / (before_ - spin);
      if (flips_++ == 0) first_flip_ = time;
      last_flip_ = time;
    }
    before_ = spin;
    last_time_ = t;
  }

  double seconds_;
  double momentum_error_ = 0.0, energy_error_ = 0.0;
  double before_ = kSpin.y(), last_time_ = 0.0, first_flip_ = 0.0, last_flip_ = 0.0;
  int flips_ = 0;
  bool broken_ = false;
};

}  // namespace

void add_free_rotation_scenes(std::vector<ScenePlan>& scenes) {
  scenes.push_back({"free_rotation", "free_rotation", {}, [](bool quick) {
                      return std::make_unique<FreeRotation>(quick ? 10.0 : 30.0);
                    }});
}

}  // namespace mrhi::benchmark
