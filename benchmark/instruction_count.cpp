// Runs the settled steps of a scene, for counting their instructions with callgrind:
// scripts/instruction_count.
#include <cstring>
#include <iostream>
#include <memory>
#include <string>

#include "crowds/scenes.h"
#include "mr_hand_interaction/live_simulation.h"
#include "support/grips.h"
#include "support/pinch_scene.h"
#include "support/tessellated.h"

// Callgrind starts and stops at these functions, by name: they must not call each other or be inlined.
extern "C" {
[[gnu::noinline]] int counted_steps(mrhi::Simulation& simulation) {
  int steps = 0;
  while (simulation.step()) ++steps;
  return steps;
}

[[gnu::noinline]] int counted_frame(mrhi::Simulation& simulation, const mrhi::HandFrame& frame) {
  int steps = 0;
  simulation.begin(frame);
  while (simulation.step()) ++steps;
  simulation.end();
  return steps;
}

[[gnu::noinline]] void counted_addition(mrhi::LiveSimulation& live, const mrhi::Body& body) {
  live.add(body);
}
}  // extern "C"

namespace mrhi::benchmark {
namespace {

using testing::at;
using testing::PinchScene;

constexpr double kCube = 0.05;  // edge [m]
constexpr int kPushed = 20;     // blocks
const Vector3 kSecondPinch(1.0, 0.0, 0.0);

struct Plan {
  const char* name;
  Scene (*scene)();
  std::vector<Hand> (*hands)(double t);
  double frame_time;  // [s]
  double settled;     // [s]
  bool whole_frame;
  bool sleep;
  double counted = 1.0;  // [s]
};

Scene pinch() {
  return PinchScene().scene();
}

/// Scene (a) with a floating operator.
Scene pinch_afloat() {
  Scene scene = pinch();
  Body person;
  person.name = "operator";
  person.is_operator = true;
  person.mass = 80.0;
  person.inertia = Vector3(11.0, 12.0, 1.5).asDiagonal();
  person.link_in_body.position = Vector3(0.0, 0.4, 0.0);
  person.start.position = -person.link_in_body.position;
  scene.operators.push_back({static_cast<int>(scene.bodies.size()), {}, 1.5});
  scene.bodies.push_back(person);
  return scene;
}

Scene pinch_19_more() {
  Scene scene = pinch();
  for (int i = 0; i < 19; ++i) {
    Body cube = scene.bodies.front();
    cube.name += std::to_string(i);
    cube.start.position = Vector3(0.2 * (i % 5), 0.2 * (i / 5), 1.0);
    scene.bodies.push_back(cube);
  }
  return scene;
}

Scene stack() {
  Body floor = testing::box_body(Vector3(2.0, 2.0, 0.1), 1.0);
  floor.name = "floor";
  floor.fixed = true;
  floor.start.position.z() = -0.05;
  Scene scene = testing::scene_of(floor);
  scene.gravity = Vector3(0, 0, -9.81);
  for (int i = 0; i < 3; ++i) {
    Body cube = testing::box_body(Vector3::Constant(kCube), 0.1);
    cube.name += std::to_string(i);
    cube.start.position = Vector3(0.002 * i, -0.003 * i, kCube * (i + 0.5));
    scene.bodies.push_back(cube);
  }
  return scene;
}

/// Two pinches a metre apart, and four more cubes out of reach of both.
Scene two_pinches() {
  Scene scene = pinch();
  for (int i = 0; i < 5; ++i) {
    Body cube = scene.bodies.front();
    cube.name += std::to_string(i);
    cube.start.position = i == 0 ? kSecondPinch : Vector3(0.2 * i, 0.5, 0.5);
    scene.bodies.push_back(cube);
  }
  return scene;
}

std::vector<Hand> swinging(double t) {
  return {PinchScene().hand(t, testing::swing(std::max(t - 0.5, 0.0), 0.1, 0.5))};
}

std::vector<Hand> two_swinging(double t) {
  const Vector3 sway = testing::swing(std::max(t - 0.5, 0.0), 0.1, 0.5);
  Hand second = PinchScene().hand(t, kSecondPinch + sway);
  second.id += 1;
  return {PinchScene().hand(t, sway), second};
}

std::vector<Hand> none(double) {
  return {};
}

/// Scene (a) with a ball of 2880 triangles instead of the cube.
Scene pinched_mesh() {
  Scene scene = pinch();
  Body& body = scene.bodies.front();
  auto ball = std::make_shared<const TriangleMesh>(testing::tessellated_ball(0.5 * kCube, 16));
  body.shapes.front().shape = Mesh{std::move(ball), "", Vector3::Ones()};
  complete(body);
  return scene;
}

Scene heap_of_12() {
  return crowds::dropped(12, 0.016, "").scene;
}

Scene heap_of_50() {
  return crowds::dropped(50, 0.04, "").scene;
}

Scene pushed_blocks() {
  return crowds::pushed(kPushed).scene;
}

Scene block_of_50() {
  return crowds::block(50).scene;
}

Scene block_of_216_without_gaps() {
  return crowds::block(216, 0.0).scene;
}

Scene far_spinning_200() {
  return crowds::far_spinning(200).scene;
}

std::vector<Hand> pushing(double t) {
  return crowds::pushed(kPushed).hands(t);
}

constexpr double kTrackerFrame = 1.0 / 120.0;  // [s]
const Plan kPlans[] = {
    {"pinch", pinch, swinging, 0.001, 0.6, false, true},
    {"pinch_afloat", pinch_afloat, swinging, 0.001, 0.6, false, true},
    {"pinch_19_more", pinch_19_more, swinging, 0.001, 0.6, false, true},
    {"stack", stack, none, 0.001, 1.0, false, false},
    {"stack_asleep", stack, none, 0.001, 1.0, false, true},
    {"pinch_mesh", pinched_mesh, swinging, 0.001, 0.6, false, true, 0.2},
    {"heap_of_12", heap_of_12, none, 0.001, 0.0, false, true, 0.5},
    {"heap_of_50_settling", heap_of_50, none, 0.001, 0.84, false, true, 0.05},  // its dearest steps
    {"push_of_20", pushed_blocks, pushing, 0.001, 0.6, false, true, 0.1},
    {"push_of_20_held", pushed_blocks, pushing, 0.001, 2.3, false, true, 0.05},  // the hand stands still
    {"block_of_50_awake", block_of_50, none, 0.001, 0.1, false, false, 0.1},
    {"block_of_216_without_gaps", block_of_216_without_gaps, none, 0.001, 0.05, false, false, 0.01},
    {"far_spinning_200", far_spinning_200, none, 0.001, 0.0, false, true, 0.1},
    {"pinch_120_hz_frame", pinch, swinging, kTrackerFrame, 0.6, true, true},
    {"two_hands_six_objects_120_hz_frame", two_pinches, two_swinging, kTrackerFrame, 0.6, true, true},
};

/// Returns the number of counted steps.
int play(const Plan& plan) {
  Configuration configuration = testing::implicit_configuration();
  configuration.contact.sleep = plan.sleep;
  configuration.step = 1.001 * plan.frame_time;  // one step per frame, although stamps are rounded
  Simulation simulation(plan.scene(), configuration);
  const long last = std::lround((plan.settled + plan.counted) / plan.frame_time);
  int steps = 0;
  for (long i = 0; i <= last; ++i) {
    const double t = static_cast<double>(i) * plan.frame_time;
    const HandFrame frame{at(t), plan.hands(t)};
    if (t < plan.settled) {
      simulation.advance(frame);
    } else if (plan.whole_frame) {
      steps += counted_frame(simulation, frame);
    } else {
      simulation.begin(frame);
      steps += counted_steps(simulation);
      simulation.end();
    }
  }
  return steps;
}

constexpr const char* kAddition = "addition_to_200";
constexpr int kThere = 200;  // bodies

/// Adds one body to two hundred while the simulation runs: work that grows in proportion to the scene
/// shows.
int add_to_200() {
  Body ball = testing::ball_body(0.02, 0.05);
  LiveSimulation live(pinch(), testing::implicit_configuration());
  const auto place = [&ball](int i) {
    ball.name = "ball_" + std::to_string(i);
    ball.start.position = Vector3(-1.0 + 0.1 * (i % 10), -1.0 + 0.1 * (i / 10 % 10), 0.2 + 0.1 * (i / 100));
  };
  for (int i = 0; i < kThere; ++i) {
    place(i);
    live.add(ball);
  }
  place(kThere);
  counted_addition(live, ball);
  return 1;
}

int list() {
  for (const Plan& plan : kPlans) std::cout << plan.name << '\n';
  std::cout << kAddition << '\n';
  return 0;
}

/// Prints what the counts depend on besides our code.
int print_compiler() {
#ifdef __clang__
  std::cout << "clang ";
#else
  std::cout << "gcc ";
#endif
  std::cout << __VERSION__ << ", Eigen " << EIGEN_WORLD_VERSION << '.' << EIGEN_MAJOR_VERSION << '.'
            << EIGEN_MINOR_VERSION << ", " << 8 * sizeof(void*) << " bit";
  std::cout << '\n';
  return 0;
}

}  // namespace
}  // namespace mrhi::benchmark

int main(int argc, char** argv) {
  using namespace mrhi::benchmark;
  const char* name = argc == 2 ? argv[1] : "";
  if (std::strcmp(name, "--list") == 0) return list();
  if (std::strcmp(name, "--compiler") == 0) return print_compiler();
  for (const Plan& plan : kPlans) {
    if (std::strcmp(name, plan.name) != 0) continue;
    std::cout << play(plan) << '\n';
    return 0;
  }
  if (std::strcmp(name, kAddition) == 0) {
    std::cout << add_to_200() << '\n';
    return 0;
  }
  std::cerr << "usage: instruction_count --list | --compiler | SCENE\n";
  return 2;
}
