#include "scene_edit.h"

#include <stdexcept>

#include "../text/text.h"

namespace mrhi {

void append(const Scene& part, Scene& scene) {
  std::vector<std::string> names;
  for (const Body& body : scene.bodies) names.push_back(body.name);
  for (const Body& body : part.bodies) {
    if (find_body(scene, body.name))
      throw std::invalid_argument("object '" + body.name + "' is there already; allowed: a name other than " +
                                  text::joined(names));
  }
  for (const Joint& joint : part.joints) {
    if (find_joint(scene, joint.name))
      throw std::invalid_argument("joint '" + joint.name +
                                  "' is there already; allowed: a name that is not taken");
  }
  const auto first = static_cast<int>(scene.bodies.size());
  scene.bodies.insert(scene.bodies.end(), part.bodies.begin(), part.bodies.end());
  for (Joint joint : part.joints) {
    joint.child += first;
    if (joint.parent != Joint::kWorld) joint.parent += first;
    scene.joints.push_back(joint);
  }
  for (Operator op : part.operators) {
    op.body += first;
    if (op.restraint) *op.restraint += first;
    scene.operators.push_back(op);
  }
  for (Tether tether : part.tethers) {
    tether.body += first;
    tether.fixture += first;
    scene.tethers.push_back(tether);
  }
}

}  // namespace mrhi
