#include "urdf.h"

#include <algorithm>

#include "../text/text.h"
#include "limits.h"
#include "mr_hand_interaction/scene/scene_loader.h"

namespace mrhi {
namespace {

void read_limits(const urdf::Joint& given, Joint& joint) {
  if (given.type != urdf::Joint::CONTINUOUS && given.limits) {
    joint.lower = given.limits->lower;
    joint.upper = given.limits->upper;
  }
  joint.start = std::min(std::max(0.0, joint.lower), joint.upper);
}

/// On the nearest body above; links without geometry on fixed joints are none.
void hang(const UrdfDocument& document, const Scene& scene, const urdf::Joint& given, Joint& joint) {
  joint.in_parent = to_pose(given.parent_to_joint_origin_transform);
  urdf::LinkConstSharedPtr link = document.model->getLink(given.parent_link_name);
  while (link != document.model->getRoot()) {
    const std::optional<int> body = find_body(scene, link->name);
    if (body) {
      joint.parent = *body;
      joint.in_parent = scene.bodies[static_cast<std::size_t>(*body)].link_in_body * joint.in_parent;
      return;
    }
    joint.in_parent = to_pose(link->parent_joint->parent_to_joint_origin_transform) * joint.in_parent;
    link = document.model->getLink(link->parent_joint->parent_link_name);
  }
}

Joint read_joint(const std::string& file, const UrdfDocument& document, const Scene& scene,
                 const urdf::Joint& given) {
  const std::string what = file + ": joint '" + text::one_line(given.name, 60) + "': ";
  if (!is_name(given.name)) throw SceneError(what + "this name is not allowed; allowed: " + kNameIs);
  Joint joint;
  joint.name = given.name;
  joint.kind = given.type == urdf::Joint::PRISMATIC ? JointKind::sliding : JointKind::turning;
  const Vector3 axis{given.axis.x, given.axis.y, given.axis.z};
  const Range& length = joint_ranges::kAxis;  // in parts: squares of what is beyond are no numbers
  if (!axis.allFinite() || !length.contains(axis.stableNorm()))
    throw SceneError(what + "axis " + text::vector(axis) + "; allowed: a direction, its length " +
                     length.describe());
  joint.axis = axis.normalized();
  const auto child = static_cast<std::size_t>(*find_body(scene, given.child_link_name));
  joint.child = static_cast<int>(child);
  joint.in_child = scene.bodies[child].link_in_body;
  read_limits(given, joint);
  hang(document, scene, given, joint);
  if (given.dynamics) {
    joint.damping = given.dynamics->damping;
    joint.friction = given.dynamics->friction;
  }
  return joint;
}

}  // namespace

std::vector<Joint> read_joints(const std::string& urdf_file, const UrdfDocument& document,
                               const Scene& scene) {
  std::vector<Joint> joints;
  for (const urdf::LinkConstSharedPtr& link : document.links) {
    if (link->parent_joint && moves(*link->parent_joint))
      joints.push_back(read_joint(urdf_file, document, scene, *link->parent_joint));
  }
  return joints;
}

}  // namespace mrhi
