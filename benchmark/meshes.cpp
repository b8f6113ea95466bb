// Cost of holding a mesh compared with a box: scene (a) with other shapes instead of the cube. Shapes
// alternate every few frames, so that other load affects all alike. Prints medians of a step and of a frame's
// end. meshes [NAME]: only shapes with NAME in their name, and the box.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "support/pinch_scene.h"
#include "support/tessellated.h"

namespace mrhi {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int kSettle = 500, kMeasured = 6000, kTurn = 100;

double microseconds(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double, std::micro>(to - from).count();
}

double median(std::vector<double>& values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

/// A block as thick as the cube, with a groove across each of its other sides, where no finger is.
TriangleMesh grooved(int n) {
  TriangleMesh mesh = testing::tessellated_box(Vector3::Constant(0.025), n);
  for (Vector3& v : mesh.vertices) {
    const double groove = std::max(0.0, 0.005 - std::abs(v.x()));
    if (std::abs(v.y()) > 0.0249) v.y() -= std::copysign(groove, v.y());
  }
  return mesh;
}

/// A ball with a hollow on top.
TriangleMesh dented(int k) {
  TriangleMesh mesh = testing::tessellated_ball(0.025, k);
  for (Vector3& v : mesh.vertices)
    if (v.z() > 0.01) v.z() = 0.02 - v.z();
  return mesh;
}

struct Held {
  std::string name;
  std::unique_ptr<Simulation> simulation;
  std::vector<double> steps, ends;

  void advance(const testing::PinchScene& pinch, int frame) {
    const double t = frame / 1000.0;
    const Vector3 sway = testing::smooth(t - 0.5, 0.5) * testing::swing(t - 0.5, 0.1, 0.5);
    simulation->begin({testing::at(t), {pinch.hand(t, sway)}});
    const Clock::time_point from = Clock::now();
    while (simulation->step()) {
    }
    const Clock::time_point between = Clock::now();
    simulation->end();
    if (frame < kSettle) return;
    steps.push_back(microseconds(from, between)), ends.push_back(microseconds(between, Clock::now()));
  }
};

Held held(const testing::PinchScene& pinch, const std::string& name, const Shape& shape) {
  Scene scene = pinch.scene();
  scene.bodies[0].shapes = {{shape, {}}};
  complete(scene.bodies[0]);
  return {name, std::make_unique<Simulation>(scene, testing::unfiltered(ContactModelKind::implicit)), {}, {}};
}

Held held(const testing::PinchScene& pinch, const std::string& name, TriangleMesh mesh) {
  const std::string triangles = std::to_string(mesh.triangles.size()) + " triangles";
  return held(pinch, name + ", " + triangles,
              Mesh{std::make_shared<const TriangleMesh>(std::move(mesh)), "", Vector3::Ones()});
}

}  // namespace
}  // namespace mrhi

int main(int argc, char** argv) {
  using namespace mrhi;
  testing::PinchScene pinch;
  if (argc > 2) pinch.overlap = std::stod(argv[2]);
  std::vector<Held> all;
  all.push_back(held(pinch, "box", Box{Vector3::Constant(0.025)}));
  all.push_back(held(pinch, "sphere", Sphere{0.025}));
  for (const int k : {14, 50, 158}) all.push_back(held(pinch, "ball", testing::tessellated_ball(0.025, k)));
  for (const int k : {14, 50, 158}) all.push_back(held(pinch, "dented ball", dented(k)));
  for (const int k : {14, 50, 158})
    all.push_back(held(pinch, "ring", testing::tessellated_ring(0.017, 0.008, k)));
  for (const int n : {8, 29, 91}) all.push_back(held(pinch, "grooved block", grooved(n)));
  if (argc > 1)
    all.erase(std::remove_if(all.begin() + 1, all.end(),
                             [&](const Held& one) { return one.name.find(argv[1]) == std::string::npos; }),
              all.end());
  for (int from = 0; from < kSettle + kMeasured; from += kTurn)
    for (Held& one : all)
      for (int frame = from; frame < from + kTurn; ++frame) one.advance(pinch, frame);
  const double box_step = median(all[0].steps), box_end = median(all[0].ends);
  std::printf("%-34s %9s %6s %9s %6s\n", "held", "step us", "x box", "end us", "x box");
  for (Held& one : all) {
    const double step = median(one.steps), end = median(one.ends);
    std::printf("%-34s %9.2f %6.2f %9.2f %6.2f\n", one.name.c_str(), step, step / box_step, end,
                end / box_end);
  }
  return 0;
}
