#pragma once

#include <vector>

#include "mr_hand_interaction/response/grip.h"
#include "support/fixtures.h"

namespace mrhi::testing {

/// The first hand of the frame about `share` of the way through that has one.
inline const Hand& hand_at(const std::vector<HandFrame>& frames, double share) {
  const auto from = static_cast<std::size_t>(share * static_cast<double>(frames.size()));
  for (std::size_t i = from; i < frames.size(); ++i)
    if (!frames[i].hands.empty()) return frames[i].hands.front();
  for (std::size_t i = from; i-- > 0;)
    if (!frames[i].hands.empty()) return frames[i].hands.front();
  throw std::runtime_error("no hand in any frame");
}

inline Body placed_body(const char* name, Shape shape, const Pose& at, bool fixed) {
  Body body = box_body(Vector3::Constant(0.04), 0.05);
  body.name = name;
  body.fixed = fixed;
  body.start = at;
  body.shapes = {{std::move(shape), {}}};
  complete(body);
  return body;
}

/// Bodies where the hand of these frames will be: a thin wall before its fingertips, a rail under its palm, a
/// free ball at the index finger's tip and a free cube between thumb and index finger. `later` moves them by
/// this share of the frames.
inline Scene scene_in_the_way(const std::vector<HandFrame>& frames, double later = 0.0) {
  const Hand &early = hand_at(frames, 0.3 + later), &middle = hand_at(frames, 0.5 + later),
             &late = hand_at(frames, 0.7 + later), &end = hand_at(frames, 0.85 + later);
  Scene scene;
  scene.name = "in_the_way";
  scene.bounds = {Vector3::Constant(-10.0), Vector3::Constant(10.0)};
  scene.bodies.push_back(
      placed_body("wall", Box{Vector3(0.003, 0.08, 0.08)}, {tip_of(early, 2), early.palm.orientation}, true));
  const Quaternion across = late.palm.orientation * Quaternion(Eigen::AngleAxisd(M_PI / 2, Vector3::UnitX()));
  scene.bodies.push_back(
      placed_body("rail", Cylinder{0.012, 0.1}, {late.palm * Vector3(0.02, 0.0, -0.03), across}, true));
  scene.bodies.push_back(
      placed_body("ball", Sphere{0.025}, {tip_of(middle, 1), Quaternion::Identity()}, false));
  scene.bodies.push_back(placed_body("cube", Box{Vector3::Constant(0.02)},
                                     {0.5 * (tip_of(end, 0) + tip_of(end, 1)), end.palm.orientation}, false));
  return scene;
}

}  // namespace mrhi::testing
