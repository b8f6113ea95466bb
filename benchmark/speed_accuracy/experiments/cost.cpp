// Cost of a step with increasing numbers of objects, far apart, close together, or on the floor, and of
// contacts.
#include "../experiment.h"
#include "pinch_hand.h"

namespace mrhi::benchmark {
namespace {

enum class Arrangement { far, near, touching };
constexpr double kCube = 0.05;

class Objects final : public Experiment {
 public:
  Objects(Arrangement arrangement, int count) : arrangement_(arrangement), count_(count) {}
  double duration() const override { return count_ > 10 ? 0.2 : 0.6; }

  World world(int) const override {
    World world;
    for (int i = 0; i < count_; ++i)
      world.bodies.push_back(box(Vector3::Constant(kCube), 0.1, start(i), {velocity(i), Vector3::Zero()}));
    if (arrangement_ == Arrangement::touching) {
      world.gravity = Vector3(0, 0, -9.81);
      BodySpec floor = floor_slab();
      floor.shape = Box{Vector3(20.0, 20.0, 0.1)};
      world.bodies.push_back(floor);
    }
    world.kinematics = PinchHand().parts();
    return world;
  }
  /// The hand moves out of reach of all objects.
  void hand(int, double t, std::vector<Pose>& poses) const override {
    for (int finger = 0; finger < PinchHand::kParts; ++finger) {
      poses[static_cast<std::size_t>(finger)] =
          PinchHand().finger(finger, 0.0, Vector3(-1.0, 0.1 * std::sin(6.0 * t), 0.5));
    }
  }
  bool observe(int, double t, const Engine& engine) override {
    if (t < duration() - 1e-9) return true;
    for (int i = 0; i < count_; ++i) {
      const Vector3 exact = start(i).position + t * velocity(i);
      const double error = (engine.motion(static_cast<std::size_t>(i)).pose.position - exact).norm();
      error_ = std::isfinite(error) ? std::max(error_, error) : error;
    }
    return false;
  }
  std::vector<Measure> measures() const override { return {{"", 1e3 * error_, "mm", !(error_ < kCube)}}; }

 private:
  Pose start(int i) const {
    const double spacing = arrangement_ == Arrangement::far ? 0.5 : kCube + 0.005;
    const bool flat = arrangement_ == Arrangement::touching;
    const int edge = flat ? 32 : 10;
    const Vector3 cell(i % edge, i / edge % edge, flat ? 0 : i / (edge * edge));
    return {spacing * cell + Vector3(0, 0, 0.5 * kCube), Quaternion::Identity()};
  }
  Vector3 velocity(int i) const {
    return arrangement_ == Arrangement::far ? Vector3(0.01 * (i % 3), 0.01 * (i % 5), 0.02) : Vector3::Zero();
  }

  Arrangement arrangement_;
  int count_;
  double error_ = 0.0;
};

/// A plate between increasing numbers of fingertips, equal on both sides.
class Contacts final : public Experiment {
 public:
  explicit Contacts(int count) : count_(count) {}
  double duration() const override { return 1.0; }
  World world(int) const override {
    World world;
    world.bodies.push_back(box(Vector3(0.02, 0.2, 0.2), 0.1));
    for (int i = 0; i < count_; ++i)
      world.kinematics.push_back({{{Vector3(side(i) * 0.025, 0, 0), Vector3::Zero(), 0.008}}, {}});
    return world;
  }
  void hand(int, double t, std::vector<Pose>& poses) const override {
    const double x = 0.01 + 0.008 + 0.005 - 0.006 * smooth(t, 0.2);
    for (int i = 0; i < count_; ++i) {
      const int place = i / 2, edge = static_cast<int>(std::ceil(std::sqrt(0.5 * count_)));
      const double middle = 0.5 * (edge - 1);
      poses[static_cast<std::size_t>(i)] = {
          Vector3(side(i) * x, 0.04 * (place % edge - middle), 0.04 * (place / edge - middle)),
          Quaternion::Identity()};
    }
  }
  bool observe(int, double, const Engine& engine) override {
    const double off = engine.motion(0).pose.position.norm();
    off_ = std::isfinite(off) ? std::max(off_, off) : off;
    return std::isfinite(off);
  }
  std::vector<Measure> measures() const override { return {{"", 1e3 * off_, "mm", !(off_ < 0.05)}}; }

 private:
  static double side(int i) { return i % 2 == 0 ? 1.0 : -1.0; }
  int count_;
  double off_ = 0.0;
};

}  // namespace

void add_cost_scenes(std::vector<ScenePlan>& scenes) {
  const std::vector<double> steps{0.001, 0.008333333};
  const std::pair<const char*, Arrangement> arrangements[] = {{"cost_far", Arrangement::far},
                                                              {"cost_near", Arrangement::near},
                                                              {"cost_touching", Arrangement::touching}};
  for (const auto& [group, arrangement] : arrangements) {
    for (const int count : {1, 10, 100, 1000}) {
      const Arrangement kind = arrangement;
      scenes.push_back({std::string(group) + "_" + std::to_string(count), group, steps,
                        [kind, count](bool) { return std::make_unique<Objects>(kind, count); }});
      scenes.back().full_only = count > (kind == Arrangement::touching ? 10 : 100);
    }
  }
  for (const int count : {2, 8, 32}) {
    scenes.push_back({"cost_contacts_" + std::to_string(count), "cost_contacts", steps,
                      [count](bool) { return std::make_unique<Contacts>(count); }});
  }
}

}  // namespace mrhi::benchmark
