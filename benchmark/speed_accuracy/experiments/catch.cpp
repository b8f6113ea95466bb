// Catching: a ball drifts into an open hand that moves with it, and the fingers close over it. Once held it
// should be at rest in the hand.
#include "../experiment.h"
#include "pinch_hand.h"

namespace mrhi::benchmark {
namespace {

constexpr double kBall = 0.03, kPalm = 0.01, kFinger = 0.008;  // radii [m]
constexpr double kApproach = 0.3;                              // of the ball towards the palm [m/s]
constexpr double kArrival = 0.35;                              // [s]
constexpr double kOpening = 1.2;                               // of the fingers [rad]
constexpr double kEnd = 1.5, kJudged = 0.3;                    // [s]
const Vector3 kHandVelocity(0, 0.2, 0);                        // [m/s]

/// A finger with one bend, from its knuckle up and over the ball; `side` +1 finger, -1 thumb.
KinematicSpec finger(double side) {
  const Vector3 knuckle = Vector3::Zero(), bend(0, 0, 0.045), tip(-side * 0.025, 0, 0.066);
  return {{{knuckle, bend, kFinger}, {bend, tip, kFinger}}, {}};
}

class Catch final : public Experiment {
 public:
  double duration() const override { return kEnd; }
  World world(int) const override {
    World world;
    world.restitution = 0.2;
    const Vector3 start(0, 0, kPalm + kBall + kApproach * kArrival);
    world.bodies.push_back(ball(kBall, 0.1, {start, Quaternion::Identity()},
                                {kHandVelocity - Vector3(0, 0, kApproach), Vector3::Zero()}));
    KinematicSpec palm;
    for (const double y : {-0.03, -0.01, 0.01, 0.03})
      palm.capsules.push_back({Vector3(-0.04, y, 0), Vector3(0.04, y, 0), kPalm});
    world.kinematics.push_back(palm);
    world.kinematics.push_back(finger(-1.0));
    for (int i = 0; i < 4; ++i) world.kinematics.push_back(finger(1.0));
    return world;
  }
  void hand(int, double t, std::vector<Pose>& poses) const override {
    const Vector3 place = t * kHandVelocity;
    const double angle = kOpening * (1.0 - smooth(t - 0.25, 0.35));
    poses[0] = {place, Quaternion::Identity()};
    for (std::size_t i = 1; i < poses.size(); ++i) {
      const double side = i == 1 ? -1.0 : 1.0;
      const double y = i == 1 ? 0.0 : -0.027 + 0.018 * static_cast<double>(i - 2);
      poses[i] = {place + Vector3(side * 0.045, y, 0),
                  Quaternion(Eigen::AngleAxisd(side * angle, Vector3::UnitY()))};
    }
  }
  bool observe(int, double t, const Engine& engine) override {
    const Motion motion = engine.motion(0);
    const Vector3 off = motion.pose.position - t * kHandVelocity - Vector3(0, 0, kPalm + kBall);
    if (t > 0.7) lost_ = lost_ || !(off.norm() < 0.03);
    if (t > kEnd - kJudged) {
      squares_ += (motion.twist.linear - kHandVelocity).squaredNorm();
      ++samples_;
    }
    return !lost_;
  }
  std::vector<Measure> measures() const override {
    return {{"", samples_ > 0 ? std::sqrt(squares_ / samples_) : kApproach, "m/s", lost_}};
  }

 private:
  double squares_ = 0.0;
  int samples_ = 0;
  bool lost_ = false;
};

}  // namespace

void add_catch_scenes(std::vector<ScenePlan>& scenes) {
  scenes.push_back({"catch", "catch", {}, [](bool) { return std::make_unique<Catch>(); }});
}

}  // namespace mrhi::benchmark
