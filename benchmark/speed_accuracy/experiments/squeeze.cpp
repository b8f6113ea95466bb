// Deep squeeze: two fingertips are tracked 15 mm into a 10 mm plate from both sides, and open again. Each
// should push from its own side throughout, so that the plate stays in place and does not fly off on release.
#include "../experiment.h"
#include "pinch_hand.h"

namespace mrhi::benchmark {
namespace {

constexpr double kThickness = 0.01, kDepth = 0.015, kGap = 0.01, kRadius = 0.008;  // [m]
constexpr double kClosing = 0.3, kOpen = 1.0, kEnd = 2.0;                          // [s]

class DeepSqueeze final : public Experiment {
 public:
  double duration() const override { return kEnd; }
  World world(int) const override {
    World world;
    world.bodies.push_back(box(Vector3(kThickness, 0.08, 0.08), 0.05));
    for (const double side : {1.0, -1.0})
      world.kinematics.push_back({{{Vector3(side * 0.025, 0, 0), Vector3::Zero(), kRadius}}, {}});
    return world;
  }
  void hand(int, double t, std::vector<Pose>& poses) const override {
    const double way = smooth(t, kClosing) - smooth(t - kOpen, kClosing);
    const double x = 0.5 * kThickness + kRadius + kGap - (kGap + kDepth) * way;
    // Opposite each other, so that the plate has no torque, and off its centre, so that symmetry does not
    // hold it.
    poses[0] = {Vector3(x, 0.006, 0.004), Quaternion::Identity()};
    poses[1] = {Vector3(-x, 0.006, 0.004), Quaternion::Identity()};
  }
  bool observe(int, double t, const Engine& engine) override {
    const Motion motion = engine.motion(0);
    const double off = motion.pose.position.norm();
    if (t <= kOpen) {
      squeezed_ = std::max(squeezed_, off);
      turned_ = std::max(turned_, motion.pose.orientation.angularDistance(Quaternion::Identity()));
      lost_ = lost_ || !(off < 0.05);
    }
    speed_ = motion.twist.linear.norm();
    return !lost_;
  }
  std::vector<Measure> measures() const override {
    return {{"", 1e3 * squeezed_, "mm", lost_},
            {"_turn", turned_ * 180.0 / M_PI, "deg", lost_},
            {"_release", speed_, "m/s", lost_}};
  }

 private:
  double squeezed_ = 0.0, turned_ = 0.0, speed_ = 0.0;
  bool lost_ = false;
};

}  // namespace

void add_squeeze_scenes(std::vector<ScenePlan>& scenes) {
  scenes.push_back({"deep_squeeze", "squeeze", {}, [](bool) { return std::make_unique<DeepSqueeze>(); }});
}

}  // namespace mrhi::benchmark
