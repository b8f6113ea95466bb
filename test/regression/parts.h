#pragma once

#include <string>
#include <vector>

#include "collision/body_manifold.h"
#include "math/fnv1a.h"
#include "mr_hand_interaction/simulation.h"
#include "mr_hand_interaction/synthetic/random.h"
#include "mr_hand_interaction/synthetic/scripted_motion.h"
#include "replay/replay_files.h"
#include "support/random_way.h"
#include "support/reviewed_bits.h"
#include "support/tessellated.h"

namespace mrhi {

/// Hash of the bits of numbers.
class Digest {
 public:
  void add(double number) { hash_.add(&number, sizeof number); }
  void add(const Vector3& vector) { hash_.add(vector.data(), sizeof vector); }
  std::string text() const { return test::hexadecimal(hash_.value); }

 private:
  Fnv1a hash_ = {};
};

constexpr std::size_t kKinds = 9;

inline Shape shape_of_kind(std::size_t kind, double scale = 1.0) {
  const auto mesh = [](TriangleMesh triangles) {
    return Mesh{std::make_shared<const TriangleMesh>(std::move(triangles)), "", Vector3::Ones()};
  };
  switch (kind) {
    case 0:
      return Box{scale * Vector3(0.03, 0.02, 0.012)};
    case 1:
      return Sphere{scale * 0.018};
    case 2:
      return Cylinder{scale * 0.016, scale * 0.025};
    case 3:
      return Pill{scale * 0.012, scale * 0.02};
    case 4:
      return mesh(testing::tessellated_box(scale * Vector3(0.025, 0.018, 0.014), 2));
    case 5:
      return mesh(testing::tessellated_ball(scale * 0.02, 5));
    case 6:
      return mesh(testing::tessellated_can(scale * 0.015, scale * 0.02, 12, 2, 2));
    case 7:
      return mesh(testing::tessellated_ring(scale * 0.025, scale * 0.01, 8));
    default:
      return Cylinder{scale * 0.025, scale * 0.008};
  }
}

/// Shapes of every kind that touch, overlap or nearly do, at random: the manifolds of one kind with each, and
/// its closest features to a capsule.
struct Touching {
  std::size_t kind;
  std::string name() const {
    static const char* const kNames[] = {"box",           "ball",           "cylinder",
                                         "capsule",       "mesh of a box",  "mesh of a ball",
                                         "mesh of a can", "mesh of a ring", "disc"};
    return std::string("touching,") + kNames[kind] + ",,,,";
  }
};

inline std::string bits_of(const Touching& touching) {
  constexpr int kPairs = 150;
  constexpr double kMargin = 0.003, kFarthest = 0.035;
  Digest manifolds, features;
  Random random(touching.kind + 1);
  const auto collider_of = [](const Shape& shape) {
    const Mesh* mesh = std::get_if<Mesh>(&shape);
    return mesh == nullptr ? nullptr : std::make_unique<MeshCollider>(*mesh->triangles);
  };
  const auto in_box = [&random](double half) {
    const double x = random.uniform(), y = random.uniform(), z = random.uniform();
    return Vector3(half * (2.0 * Vector3(x, y, z) - Vector3::Ones()));
  };
  const auto turn = [&random] {
    const Vector3 axis = random.gaussian_vector(1.0);
    return Quaternion(random.gaussian(), axis.x(), axis.y(), axis.z()).normalized();
  };
  const Shape a = shape_of_kind(touching.kind);
  const auto collider_a = collider_of(a);
  const ManifoldShape of_a(a, collider_a.get());
  for (std::size_t kind = 0; kind < kKinds; ++kind) {
    const Shape b = shape_of_kind(kind);
    const auto collider_b = collider_of(b);
    const ManifoldShape of_b(b, collider_b.get());
    for (int i = 0; i < kPairs; ++i) {
      const Pose pose_b{in_box(0.1), turn()};
      const Pose pose_a{pose_b.position + in_box(kFarthest), turn()};
      const Manifold manifold = body_manifold(of_a, pose_a, of_b, pose_b, kMargin, 1e-4);
      manifolds.add(manifold.count);
      if (manifold.count > 0) manifolds.add(manifold.normal), manifolds.add(manifold.breadth);
      for (const ManifoldPoint& point : manifold)
        manifolds.add(point.point), manifolds.add(point.depth), manifolds.add(point.feature);
    }
  }
  for (int i = 0; i < 20 * kPairs; ++i) {
    const Vector3 start = in_box(0.04);
    const Capsule capsule{start, start + in_box(0.03), 0.008};
    const auto closest = of_a.closest(capsule, kMargin);
    features.add(closest.has_value());
    if (!closest) continue;
    const AxisSpan span = of_a.span(capsule, *closest);
    features.add(closest->distance), features.add(closest->normal), features.add(closest->point);
    features.add(closest->axis_parameter), features.add(span.s0), features.add(span.s1);
  }
  return manifolds.text() + "," + features.text();
}

/// A motion in noise whose hand meets bodies at random: their state, and the rendered hand.
struct RandomScene {
  const char* motion;
  std::uint64_t seed;
  std::string name() const {
    return std::string(motion) + ",random " + std::to_string(seed) + ",implicit,0,90,1";
  }
};
constexpr RandomScene kRandomScenes[] = {
    {"grasp_cube", 1},  {"slap", 3},   {"catch_ball", 5},     {"pinch_long", 7}, {"turn_valve", 9},
    {"open_hatch", 11}, {"nudge", 13}, {"squeeze_tongs", 15}, {"grasp_ball", 2}, {"flip_switch", 4}};

inline std::string bits_of(const RandomScene& run) {
  std::vector<HandFrame> frames;
  TrackingNoise noise(1.0, 1);
  for (JointsFrame& joints : test::motion_frames(run.motion, 90, 0)) {
    noise.apply(joints);
    frames.push_back({joints.stamp, {}});
    for (const HandJoints& hand : joints.hands)
      frames.back().hands.push_back(complete_hand(hand, default_device_mount()));
  }
  Simulation simulation(testing::scene_at_random(frames, run.seed), Configuration());
  Digest state, rendered;
  for (const HandFrame& frame : frames) {
    if (simulation.advance(frame) != Rejection::none) continue;
    for (const BodyState& body : simulation.state().bodies)
      state.add(body.pose.position), state.add(body.angular_momentum);
    for (const RenderedHand& hand : simulation.result().rendered)
      for (const Capsule& capsule : hand.hand.capsules)
        rendered.add(capsule.start), rendered.add(capsule.end);
  }
  return state.text() + "," + rendered.text();
}

/// The motion that grasps an object.
struct Grasping {
  std::size_t kind;
  double scale;
  std::string name() const {
    return "grasp_object," + std::to_string(kind) + " x " + std::to_string(scale).substr(0, 3) + ",,,,";
  }
};

inline std::string bits_of(const Grasping& grasping) {
  Body body = testing::placed_body("object", shape_of_kind(grasping.kind, grasping.scale),
                                   {{0.02, 0.01, 0.2}, Quaternion(0.9, 0.3, 0.2, 0.1).normalized()}, false);
  const ScriptedMotion motion = grasp_object(testing::scene_of(body));
  Digest times, joints;
  for (const Keyframe& keyframe : motion.keyframes) times.add(keyframe.time);
  for (int i = 0; i < 50; ++i) {
    const double time = i * motion.run_time() / 50;
    for (const HandJoints& hand :
         sample(motion, Side::right, testing::at(time), default_device_mount()).hands)
      for (const auto& finger : hand.joints)
        for (const auto& joint : finger) joints.add(joint.value_or(Vector3::Zero()));
  }
  return times.text() + "," + joints.text();
}

}  // namespace mrhi
