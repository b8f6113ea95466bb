#include "scene_edit.h"

namespace mrhi {
namespace {

/// For each of the scene's bodies whether it is the one or hangs on it: joints come before those of what
/// hangs on them.
std::vector<char> those_that_go(std::size_t body, const Scene& scene) {
  std::vector<char> goes(scene.bodies.size(), 0);
  goes[body] = 1;
  for (const Joint& joint : scene.joints) {
    if (joint.parent != Joint::kWorld && goes[static_cast<std::size_t>(joint.parent)] != 0)
      goes[static_cast<std::size_t>(joint.child)] = 1;
  }
  return goes;
}

}  // namespace

std::vector<std::size_t> hanging_on(std::size_t body, const Scene& scene) {
  const std::vector<char> goes = those_that_go(body, scene);
  std::vector<std::size_t> bodies;
  for (std::size_t b = 0; b < goes.size(); ++b) {
    if (goes[b] != 0) bodies.push_back(b);
  }
  return bodies;
}

void remove_body(std::size_t body, Scene& scene) {
  const std::vector<char> goes = those_that_go(body, scene);
  std::vector<int> place;  // of each body among those that stay
  std::vector<Body> bodies;
  for (std::size_t b = 0; b < goes.size(); ++b) {
    place.push_back(static_cast<int>(bodies.size()));
    if (goes[b] == 0) bodies.push_back(std::move(scene.bodies[b]));
  }
  scene.bodies = std::move(bodies);
  std::vector<Joint> joints;
  for (Joint& joint : scene.joints) {
    if (goes[static_cast<std::size_t>(joint.child)] != 0) continue;
    if (joint.parent != Joint::kWorld) joint.parent = place[static_cast<std::size_t>(joint.parent)];
    joint.child = place[static_cast<std::size_t>(joint.child)];
    joints.push_back(std::move(joint));
  }
  scene.joints = std::move(joints);
  const auto stays = [&](int b) { return goes[static_cast<std::size_t>(b)] == 0; };
  std::vector<Operator> operators;
  for (Operator op : scene.operators) {
    if (!stays(op.body)) continue;
    op.body = place[static_cast<std::size_t>(op.body)];
    if (op.restraint && !stays(*op.restraint)) op.restraint.reset();
    if (op.restraint) op.restraint = place[static_cast<std::size_t>(*op.restraint)];
    operators.push_back(op);
  }
  scene.operators = std::move(operators);
  std::vector<Tether> tethers;
  for (Tether tether : scene.tethers) {
    if (!stays(tether.body) || !stays(tether.fixture)) continue;
    tether.body = place[static_cast<std::size_t>(tether.body)];
    tether.fixture = place[static_cast<std::size_t>(tether.fixture)];
    tethers.push_back(tether);
  }
  scene.tethers = std::move(tethers);
}

}  // namespace mrhi
