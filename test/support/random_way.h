#pragma once

#include "mr_hand_interaction/synthetic/random.h"
#include "support/in_the_way.h"

namespace mrhi::testing {

/// Bodies at random along the way of the hands of these frames: from 3 to 8 of them, each within 30 mm of a
/// random point of a random hand, of random shape, size and pose, half of them fixed. Free ones overlap
/// nothing as they start.
class RandomWay {
 public:
  explicit RandomWay(std::uint64_t seed) : random_(seed) {}

  Scene scene(const std::vector<HandFrame>& frames) {
    Scene scene;
    scene.name = "random_way";
    scene.bounds = {Vector3::Constant(-10.0), Vector3::Constant(10.0)};
    const int count = 3 + static_cast<int>(random_.uniform() * 6.0);
    for (int i = 0; i < count; ++i) {
      const bool fixed = random_.uniform() < 0.5;
      const Hand& hand = hand_at(frames, random_.uniform());
      const Pose pose{point_of(hand) + random_.gaussian_vector(0.01), orientation()};
      Body body = placed_body("", shape(), pose, fixed);
      body.name = "body_" + std::to_string(i);
      if (touches(scene, body)) continue;
      scene.bodies.push_back(std::move(body));
    }
    return scene;
  }

 private:
  double between(double least, double most) { return least + (most - least) * random_.uniform(); }

  Vector3 point_of(const Hand& hand) {
    const auto capsule = static_cast<std::size_t>(random_.uniform() * kCapsules);
    const double s = random_.uniform();
    return hand.capsules[capsule].radius > 0.0 ? hand.capsules[capsule].axis_point(s) : hand.palm.position;
  }
  Quaternion orientation() {
    Eigen::Vector4d coefficients;
    for (int i = 0; i < 4; ++i) coefficients[i] = random_.gaussian();
    return Quaternion(coefficients).normalized();
  }
  Shape shape() {
    const double kind = random_.uniform();
    if (kind < 0.3) return Sphere{between(0.01, 0.04)};
    if (kind < 0.6) {
      const double radius = between(0.004, 0.04), half_length = between(0.01, 0.1);
      return Cylinder{radius, half_length};
    }
    const double x = between(0.002, 0.06), y = between(0.005, 0.08), z = between(0.005, 0.08);
    return Box{{x, y, z}};
  }
  static bool touches(const Scene& scene, const Body& added) {
    return std::any_of(scene.bodies.begin(), scene.bodies.end(), [&](const Body& body) {
      return !(body.fixed && added.fixed) && (body.start.position - added.start.position).norm() <
                                                 body.bounding_radius + added.bounding_radius;
    });
  }

  Random random_;
};

/// Another scene for each seed: the bodies of scene_in_the_way, moved along the way (seed 0: not), or all at
/// random.
inline Scene scene_at_random(const std::vector<HandFrame>& frames, std::uint64_t seed) {
  if (seed == 0) return scene_in_the_way(frames);
  if (seed % 2 == 0) return scene_in_the_way(frames, -0.3 + 0.45 * Random(seed).uniform());
  return RandomWay(seed).scene(frames);
}

}  // namespace mrhi::testing
