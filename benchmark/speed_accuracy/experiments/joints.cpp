// A hinged body is pushed at a known point along a known path: a door by its handle, a valve by both ends of
// its bar. The hand's parts rotate about the hinge with it, so nothing slides. With rigid contact the angle
// is the hand's, and the force follows from inertia and the hinge's friction.
#include "../experiment.h"
#include "pinch_hand.h"

namespace mrhi::benchmark {
namespace {

constexpr double kRadius = 0.008, kHalfTip = 0.0125;  // of a fingertip [m]
constexpr double kGap = 0.002, kApproach = 0.1;       // distance and duration of the hand's approach [m, s]
constexpr double kSettled = 0.3;                      // time after it from which forces are measured [s]
constexpr double kLost = 0.05;                        // distance from the hand: the run is invalid [m]

/// A fingertip along the axis that touches the face y = `side` * `half` from outside, with lever `arm`.
Capsule fingertip(double arm, double half, double side) {
  const Vector3 centre(arm, side * (half + kRadius), 0.0);
  return {centre - kHalfTip * Vector3::UnitZ(), centre + kHalfTip * Vector3::UnitZ(), kRadius};
}

/// A homogeneous box on a hinge along z through the world's origin.
class Turned : public Experiment {
 public:
  World world(int) const override {
    World world;
    world.friction = surface_friction_;
    world.bodies.push_back(box(size_, mass_, {centre_, Quaternion::Identity()}));
    world.hinges.push_back({0, Vector3::Zero(), Vector3::UnitZ(), friction_});
    for (const Capsule& tip : tips_) world.kinematics.push_back({{tip}, {}});
    return world;
  }
  void hand(int, double t, std::vector<Pose>& poses) const override {
    for (Pose& pose : poses)
      pose = {Vector3::Zero(), Quaternion(Eigen::AngleAxisd(hand_angle(t), Vector3::UnitZ()))};
  }
  bool observe(int, double t, const Engine& engine) override {
    const Pose pose = engine.motion(0).pose;
    const Quaternion& q = pose.orientation;
    const double turned = 2.0 * std::atan2(q.z(), q.w());
    drift_ = std::max(drift_, (pose * Vector3(-centre_)).norm());
    const double off = arm_ * (turned - hand_angle(t));
    if (t <= kApproach) return true;
    if (t <= kApproach + pushed_) off_ = std::max(off_, std::abs(off));
    lost_ = lost_ || !(std::abs(off) < kLost) || !(drift_ < kLost);
    if (t > kApproach + kSettled && t <= kApproach + pushed_) feel(engine);
    return !lost_;
  }
  std::vector<Measure> measures() const override {
    return {{"_place", 1e3 * off_, "mm", lost_}, {"_hinge", 1e3 * drift_, "mm", lost_}};
  }

 protected:
  virtual double angle(double t) const = 0;  // of the hand after first touch [rad]
  virtual void feel(const Engine&) {}
  double inertia() const {
    return mass_ * ((size_.x() * size_.x() + size_.y() * size_.y()) / 12.0 + centre_.squaredNorm());
  }

  Vector3 size_, centre_ = Vector3::Zero();
  double mass_ = 1.0, surface_friction_ = 0.8, friction_ = 0.0, arm_ = 1.0, pushed_ = 1.0;
  std::vector<Capsule> tips_;

 private:
  double hand_angle(double t) const {
    return angle(std::max(0.0, t - kApproach)) - kGap / arm_ * (1.0 - smooth(t, kApproach));
  }

  double off_ = 0.0, drift_ = 0.0;
  bool lost_ = false;
};

/// A door of 40 by 60 cm and 2 kg, pushed 35 cm from its hinge with constant acceleration: 1 rad in a second.
/// Its surface is slippery, so that only the normal force pushes: within a step engines move the hand on a
/// straight line, and its deviation from the arc would cause friction.
class Door final : public Turned {
 public:
  Door() {
    size_ = {0.4, 0.02, 0.6}, centre_ = {0.2, 0, 0};
    mass_ = 2.0, surface_friction_ = 0.0, friction_ = 0.2, arm_ = 0.35, pushed_ = 1.0;
    tips_ = {fingertip(arm_, 0.5 * size_.y(), -1.0)};
  }
  double duration() const override { return kApproach + pushed_; }
  bool watches_forces() const override { return true; }
  std::vector<Measure> measures() const override {
    auto measures = Turned::measures();
    const double error = std::sqrt(squares_ / std::max(1, count_));
    measures.push_back({"_force", 1e2 * error, "%", measures[0].failed || !std::isfinite(error)});
    return measures;
  }

 private:
  static constexpr double kAcceleration = 2.0;  // [rad/s^2]
  double angle(double t) const override { return 0.5 * kAcceleration * t * t; }
  void feel(const Engine& engine) override {
    const double wanted = (inertia() * kAcceleration + friction_) / arm_;
    const double error = engine.pressing(0) / wanted - 1.0;
    squares_ += error * error;
    ++count_;
  }

  double squares_ = 0.0;
  int count_ = 0;
};

/// A bar of 16 cm on a stiff valve, rotated by a quarter turn at both ends.
class Valve final : public Turned {
 public:
  Valve() {
    size_ = {0.16, 0.03, 0.03};
    mass_ = 0.3, friction_ = 0.3, arm_ = 0.06, pushed_ = 1.0;
    tips_ = {fingertip(arm_, 0.5 * size_.y(), -1.0), fingertip(-arm_, 0.5 * size_.y(), 1.0)};
  }
  double duration() const override { return kApproach + pushed_ + 0.5; }

 private:
  double angle(double t) const override { return 0.5 * M_PI * smooth(t, pushed_); }
};

}  // namespace

void add_joint_scenes(std::vector<ScenePlan>& scenes) {
  scenes.push_back({"door", "joints", {}, [](bool) { return std::make_unique<Door>(); }});
  scenes.push_back({"valve", "joints", {}, [](bool) { return std::make_unique<Valve>(); }});
}

}  // namespace mrhi::benchmark
