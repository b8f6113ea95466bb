// Large islands: dropped dice and cubes in a heap, blocks pushed over a table by a hand, a block of cubes at
// rest. The scenes of benchmark/crowds, for engines without scene files.
#include <algorithm>
#include <array>
#include <cmath>

#include "../experiment.h"

namespace mrhi::benchmark {
namespace {

constexpr double kGravity = 9.81;    // [m/s^2]
constexpr double kDensity = 1000.0;  // [kg/m^3]

/// Pseudo-random, between -1 and 1.
double scattered(int i) {
  return 2.0 * std::fmod(0.618033988749895 * i + 0.37 * std::fmod(0.7548776662 * i * i, 1.0), 1.0) - 1.0;
}
Quaternion turned(int i) {
  return Quaternion(1.0, scattered(3 * i), scattered(3 * i + 1), scattered(3 * i + 2)).normalized();
}
/// Position of a cube in layers of a square of `side` cubes with spacing `pitch`.
Vector3 in_square(int i, int side, double pitch) {
  const double middle = 0.5 * (side - 1);
  return pitch * Vector3(i % side - middle, i / side % side - middle, i / (side * side));
}
int edge_of(double count) {
  return std::max(1, static_cast<int>(std::lround(std::cbrt(count))));
}

/// Common part: equal boxes on a floor, and the deepest penetration of it.
class Crowd : public Experiment {
 public:
  Crowd(int count, double edge, double seconds) : Crowd(count, Vector3::Constant(edge), seconds) {}
  Crowd(int count, const Vector3& size, double seconds)
      : count_(count), size_(size), edge_(size.minCoeff()), seconds_(seconds) {}
  double duration() const override { return seconds_; }
  World world(int trial) const override {
    World world;
    world.gravity = Vector3(0, 0, -kGravity);
    for (int i = 0; i < count_; ++i)
      world.bodies.push_back(box(size_, kDensity * size_.prod(), start(i, trial)));
    world.bodies.push_back(floor_slab());
    return world;
  }
  bool observe(int, double t, const Engine& engine) override {
    for (int i = 0; i < count_; ++i) {
      const Motion motion = engine.motion(static_cast<std::size_t>(i));
      const Vector3 up = motion.pose.orientation.conjugate() * Vector3::UnitZ();
      const double deep = 0.5 * up.cwiseAbs().dot(size_) - motion.pose.position.z();
      lost_ = lost_ || !(deep < edge_) || !(motion.pose.position.norm() < kFar);
      deepest_ = std::max(deepest_, deep);
      look(i, t, motion);
    }
    return !lost_;
  }
  std::vector<Measure> measures() const override { return {{"_sunk", 1e3 * deepest_, "mm", lost_}}; }

 protected:
  virtual Pose start(int i, int trial) const = 0;
  virtual void look(int /*i*/, double /*t*/, const Motion&) {}

  int count_;
  Vector3 size_;
  double edge_, seconds_;  // edge_: the smallest
  bool lost_ = false;

 private:
  static constexpr double kFar = 1.9;  // thrown off the floor [m]
  double deepest_ = 0.0;
};

/// How a heap or a wall falls, and what that costs, depends on the last bits of its start.
constexpr int kFalls = 4;

/// Dropped from a hand's breadth above the floor, in random orientations: they come to rest.
class Heap final : public Crowd {
 public:
  using Crowd::Crowd;
  int trials() const override { return kFalls; }
  std::vector<Measure> measures() const override {
    std::vector<Measure> measures = Crowd::measures();
    measures.push_back({"_unrest", 1e3 * fastest_, "mm/s", lost_});
    return measures;
  }

 private:
  static constexpr double kAtRest = 0.2;  // time at the end [s]
  Pose start(int i, int trial) const override {
    const int draw = i + 1000 * trial;
    const Vector3 place = in_square(i, edge_of(0.2 * count_), 1.8 * edge_) +
                          0.1 * edge_ * Vector3(scattered(draw), scattered(draw + 7), 0) +
                          Vector3(0, 0, 2.0 * edge_);
    return {place, turned(i)};
  }
  void look(int, double t, const Motion& motion) override {
    if (t < seconds_ - kAtRest) return;
    const double speed = motion.twist.linear.norm() + edge_ * motion.twist.angular.norm();
    fastest_ = std::isfinite(speed) ? std::max(fastest_, speed) : speed;
  }
  double fastest_ = 0.0;
};

/// Four upright fingers sweep blocks along a table.
class Push final : public Crowd {
 public:
  explicit Push(int count) : Crowd(count, 0.03, 2.5) {}
  World world(int trial) const override {
    World world = Crowd::world(trial);
    KinematicSpec comb;
    for (int finger = 0; finger < 4; ++finger) {
      const Vector3 end(0, 0.02 * (finger - 1.5), 0.01);
      comb.capsules.push_back({end + Vector3(0, 0, 0.025), end, 0.008});
    }
    world.kinematics.push_back(comb);
    return world;
  }
  void hand(int, double t, std::vector<Pose>& poses) const override {
    poses[0] = {Vector3(-0.25 + 0.15 * std::min(t, 2.0), 0, 0), Quaternion::Identity()};
  }

 private:
  Pose start(int i, int) const override {
    return {Vector3(0.031 * (i % 10) - 0.15, 0.031 * (i / 10 - 2), 0.5 * edge_),
            Quaternion(Eigen::AngleAxisd(0.02 * scattered(i), Vector3::UnitZ()))};
  }
};

/// Cubes stacked face to face, with gaps sideways: none moves. None may sleep.
class Block final : public Crowd {
 public:
  Block(int count, double gap) : Crowd(count, 0.04, count > 500 ? 0.1 : 0.5), gap_(gap) {}
  World world(int trial) const override {
    World world = Crowd::world(trial);
    world.sleep = false;
    return world;
  }
  std::vector<Measure> measures() const override { return {{"", 1e3 * moved_, "mm", lost_}}; }

 private:
  Pose start(int i, int) const override {
    const double wider = 1.0 + gap_ / edge_;
    const Vector3 place = in_square(i, edge_of(count_), edge_).cwiseProduct(Vector3(wider, wider, 1.0));
    return {place + Vector3(0, 0, 0.5 * edge_), Quaternion::Identity()};
  }
  void look(int i, double, const Motion& motion) override {
    moved_ = std::max(moved_, (motion.pose.position - start(i, 0).position).norm());
  }
  double gap_;
  double moved_ = 0.0;
};

/// A wall in stretcher bond, inclined beyond its stability: it falls over.
class Wall final : public Crowd {
 public:
  Wall() : Crowd(kRows * kBricks, Vector3(0.08, 0.04, 0.03), 3.0) {}
  int trials() const override { return kFalls; }

 private:
  static constexpr int kRows = 8, kBricks = 6;
  Pose start(int i, int trial) const override {
    const int row = i / kBricks;
    const double along = (i % kBricks - 0.5 * (kBricks - 1) + 0.5 * (row % 2)) * size_.x();
    const Quaternion lean(
        Eigen::AngleAxisd(-0.25 - 0.005 * trial, Vector3::UnitX()));  // about its lower edge
    return {lean * Vector3(along, -0.5 * size_.y(), (row + 0.5) * size_.z()), lean};
  }
};

}  // namespace

void add_crowd_scenes(std::vector<ScenePlan>& scenes) {
  constexpr double kStep = 0.001, kFrame = 1.0 / 120.0;  // [s]
  const auto add = [&](const std::string& name, double step, const auto& make) {
    scenes.push_back({name, "crowd", {step}, [make](bool) { return make(); }});
    scenes.back().full_only = true;
    scenes.back().budget = 8.0;  // enough for slow engines
  };
  const auto heap = [](int count, double edge) {
    return [count, edge] { return std::make_unique<Heap>(count, edge, 2.5); };
  };
  const auto block = [](int count, double gap) {
    return [count, gap] { return std::make_unique<Block>(count, gap); };
  };
  const auto wall = [] { return std::make_unique<Wall>(); };
  add("crowd_heap_8", kStep, heap(8, 0.016));
  add("crowd_heap_50", kStep, heap(50, 0.04));
  add("crowd_push_50", kStep, [] { return std::make_unique<Push>(50); });
  for (const int count : {50, 1000}) add("crowd_block_" + std::to_string(count), kStep, block(count, 2e-5));
  add("crowd_close_200", kStep, block(200, 5e-6));
  for (const int count : {50, 200, 1000})
    add("crowd_flush_" + std::to_string(count), kStep, block(count, 0.0));
  add("crowd_flush_200_frame", kFrame, block(200, 0.0));
  add("crowd_wall_48", kStep, wall);
  add("crowd_wall_48_frame", kFrame, wall);
}

}  // namespace mrhi::benchmark
