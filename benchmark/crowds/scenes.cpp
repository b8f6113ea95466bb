#include "scenes.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "support/grips.h"

namespace mrhi::crowds {
namespace {

constexpr double kGravity = 9.81;    // [m/s^2]
constexpr double kDensity = 1000.0;  // [kg/m^3]

Body floor_body() {
  Body floor = testing::box_body(Vector3(2.0, 2.0, 0.1), 1.0);
  floor.name = "floor";
  floor.fixed = true;
  floor.start.position.z() = -0.05;
  return floor;
}

Scene on_floor() {
  Scene scene = testing::scene_of(floor_body());
  scene.gravity = Vector3(0, 0, -kGravity);
  return scene;
}

void add_cube(Scene& scene, double edge, const Vector3& position,
              const Quaternion& orientation = Quaternion::Identity()) {
  Body cube = testing::box_body(Vector3::Constant(edge), kDensity * edge * edge * edge);
  cube.name = "cube" + std::to_string(scene.bodies.size());
  cube.start = {position, orientation};
  scene.bodies.push_back(cube);
}

/// Pseudo-random, between -1 and 1.
double scattered(int i) {
  return 2.0 * std::fmod(0.618033988749895 * i + 0.37 * std::fmod(0.7548776662 * i * i, 1.0), 1.0) - 1.0;
}

Quaternion turned(int i) {
  return Quaternion(1.0, scattered(3 * i), scattered(3 * i + 1), scattered(3 * i + 2)).normalized();
}

/// Four upright fingers side by side along x.
Hand comb(std::uint32_t id, const Vector3& tip) {
  Hand hand = testing::empty_hand(id);
  for (int finger = 1; finger < kFingers; ++finger) {
    const Vector3 end = tip + Vector3(0, 0.02 * (finger - 2.5), 0.01);
    testing::add_finger(hand, capsule_index(finger, 3), end + Vector3(0, 0, 0.025), end, 0.008);
  }
  hand.palm.position = tip + Vector3(0, 0, 0.08);
  return hand;
}

/// Position of a cube in a square of `side` cubes with spacing `pitch`.
Vector3 in_square(int i, int side, double pitch) {
  return Vector3(pitch * (i % side - 0.5 * (side - 1)), pitch * (i / side % side - 0.5 * (side - 1)),
                 pitch * (i / (side * side)));
}

/// A cloud of cubes that collapses, without gravity or floor.
Crowd gathering(int count) {
  constexpr double kEdge = 0.04;
  Crowd crowd{std::to_string(count) + " cubes thrown together in 0 g", {}, 1.5};
  crowd.scene.name = "gathering";
  crowd.scene.bounds = {Vector3::Constant(-100.0), Vector3::Constant(100.0)};
  const int side = static_cast<int>(std::lround(std::cbrt(count)));
  for (int i = 0; i < count; ++i) {
    add_cube(crowd.scene, kEdge, in_square(i, side, 2.0 * kEdge), turned(i));
    crowd.scene.bodies.back().start_twist.linear =
        -2.0 * (crowd.scene.bodies.back().start.position - Vector3(0, 0, 0.12));
  }
  return crowd;
}

}  // namespace

Crowd dropped(int count, double edge, const char* name) {
  Crowd crowd{name, on_floor(), 3.0};
  const int side = static_cast<int>(std::lround(std::cbrt(0.2 * count)));
  for (int i = 0; i < count; ++i) {
    const Vector3 place =
        in_square(i, side, 1.8 * edge) + 0.1 * edge * Vector3(scattered(i), scattered(i + 7), 0);
    add_cube(crowd.scene, edge, place + Vector3(0, 0, 2.0 * edge), turned(i));
  }
  return crowd;
}

Crowd block(int count, double gap) {
  constexpr double kEdge = 0.04;
  Crowd crowd{"block of " + std::to_string(count) + " at rest, awake", on_floor(), count > 500 ? 0.3 : 1.0};
  crowd.sleep = false;
  const int side = std::max(1, static_cast<int>(std::lround(std::cbrt(count * 1.0))));
  for (int i = 0; i < count; ++i) {
    const double apart = (kEdge + gap) / kEdge;
    add_cube(crowd.scene, kEdge,
             in_square(i, side, kEdge).cwiseProduct(Vector3(apart, apart, 1.0)) + Vector3(0, 0, 0.5 * kEdge));
  }
  return crowd;
}

Crowd overlapping(int count) {
  Crowd crowd{std::to_string(count) + " boxes overlapping", {}, 0.3};
  crowd.scene.name = "overlapping";
  for (int i = 0; i < count; ++i) add_cube(crowd.scene, 0.05, Vector3(0.0, 0.0, 0.0));
  return crowd;
}

Crowd far_spinning(int count) {
  Crowd crowd{std::to_string(count) + " far, spinning", {}, 1.0};
  crowd.scene.name = "far";
  crowd.scene.bounds = {Vector3::Constant(-100.0), Vector3::Constant(100.0)};
  for (int i = 0; i < count; ++i) {
    Body box = testing::box_body(Vector3(0.05, 0.04, 0.03), 0.1);
    box.name = "box" + std::to_string(i);
    box.start.position = in_square(i, 10, 0.5);
    box.start_twist.angular = 5.0 * Vector3(scattered(i), scattered(i + 3), scattered(i + 11));
    crowd.scene.bodies.push_back(box);
  }
  return crowd;
}

Crowd far_from_a_grasp(int count) {
  constexpr double kEdge = 0.04;
  const Vector3 place(-1, -1, 0);
  Crowd crowd = far_spinning(count);
  crowd.name = "a cube is held, " + crowd.name;
  crowd.frame = 1.0 / 120.0;
  add_cube(crowd.scene, kEdge, place);
  crowd.hands = [place](double t) -> std::vector<Hand> {
    const Vector3 side = (0.5 * kEdge + testing::closing_gap(t - 0.1, 0.002)) * Vector3::UnitX();
    Hand hand = testing::empty_hand(1);
    testing::add_flat_finger(hand, capsule_index(1, 3), place + side, Vector3::UnitX(), Vector3::UnitY());
    testing::add_flat_finger(hand, capsule_index(0, 3), place - side, -Vector3::UnitX(), Vector3::UnitY());
    return {hand};
  };
  return crowd;
}

Crowd pushed(int count) {
  constexpr double kEdge = 0.03, kFrom = -0.25, kSpeed = 0.15;
  Crowd crowd{"a hand pushes " + std::to_string(count) + " blocks", on_floor(), 3.0};
  for (int i = 0; i < count; ++i) {
    const Vector3 place(0.031 * (i % 10) - 0.15, 0.031 * (i / 10 - 2), 0.5 * kEdge);
    add_cube(crowd.scene, kEdge, place, Quaternion(Eigen::AngleAxisd(0.02 * scattered(i), Vector3::UnitZ())));
  }
  crowd.hands = [](double t) -> std::vector<Hand> {
    return {comb(1, Vector3(kFrom + kSpeed * std::min(t, 2.0), 0, 0))};
  };
  return crowd;
}

Crowd lifted(int count) {
  constexpr double kEdge = 0.05, kPitch = kEdge + 0.0005;
  Crowd crowd{"two hands, " + std::to_string(count) + " boxes, one lifted", on_floor(), 4.0};
  crowd.frame = 1.0 / 120.0;
  crowd.whole_frame = true;
  for (int i = 0; i < count; ++i)
    add_cube(crowd.scene, kEdge, Vector3(kPitch * (i % 10), kPitch * (i / 10), 0.5 * kEdge - 1e-7));
  // The corner's box, pinched above its neighbours' centres and lifted out.
  crowd.hands = [](double t) -> std::vector<Hand> {
    const Vector3 place(0.0, 0.0, 0.045 + 0.1 * testing::smooth(t - 1.0, 1.0));
    const double gap = testing::closing_gap(t - 0.3, 0.002);
    Hand lifting = testing::empty_hand(1);
    testing::add_flat_finger(lifting, capsule_index(1, 3), place + Vector3(-0.025 - gap, 0.0, 0.0),
                             -Vector3::UnitX(), Vector3::UnitY());
    testing::add_flat_finger(lifting, capsule_index(0, 3), place + Vector3(0.0, -0.025 - gap, 0.0),
                             -Vector3::UnitY(), Vector3::UnitX());
    testing::add_fingertip(lifting, capsule_index(2, 3),
                           place + Vector3(0.025, 0.025, 0.0) + gap * Vector3(0.7, 0.7, 0),
                           Vector3(std::sqrt(0.5), std::sqrt(0.5), 0.0));
    return {lifting, comb(2, Vector3(0.3, 0.1, 0.05 + 0.002 * std::sin(6.0 * t)))};
  };
  return crowd;
}

/// A block without gaps.
Crowd wall() {
  Crowd crowd = block(200, 1e-6);
  crowd.name = "block of 200 without gaps, awake";
  return crowd;
}

std::vector<Crowd> all_crowds() {
  return {dropped(8, 0.016, "8 dice dropped"),
          dropped(12, 0.016, "12 dice dropped"),
          dropped(50, 0.04, "50 cubes dropped"),
          gathering(50),
          pushed(50),
          block(50),
          block(200),
          block(1000),
          wall(),
          overlapping(4),
          overlapping(8),
          overlapping(12),
          overlapping(14),
          overlapping(30),
          far_spinning(1000),
          far_from_a_grasp(1000),
          lifted(50)};
}

}  // namespace mrhi::crowds
