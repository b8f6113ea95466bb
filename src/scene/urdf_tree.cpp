#include "urdf.h"

#include "../text/text.h"
#include "mr_hand_interaction/scene/scene_loader.h"

namespace mrhi {
namespace {

class Tree {
 public:
  Tree(const std::string& file, const UrdfDocument& document)
      : file_(file), model_(*document.model), root_(*model_.getRoot()) {
    check_root();
    for (const auto& entry : model_.joints_) check_joint(*entry.second);
  }

  PlacedLink place(const urdf::LinkConstSharedPtr& link) const {
    PlacedLink placed{link, link->parent_joint->type == urdf::Joint::FIXED, Pose{}};
    const urdf::Link* at = link.get();
    for (std::size_t steps = 0; at != &root_; ++steps) {
      if (steps > model_.links_.size()) fail("link '" + link->name + "' hangs in a loop of joints");
      placed.in_world = to_pose(at->parent_joint->parent_to_joint_origin_transform) * placed.in_world;
      at = model_.getLink(at->parent_joint->parent_link_name).get();
    }
    return placed;
  }

 private:
  void check_root() const {
    if (root_.collision_array.empty() && root_.visual_array.empty()) return;
    fail("root link '" + root_.name +
         "' has geometry; allowed: a root without any ('world'), others joined to it");
  }

  void check_joint(const urdf::Joint& joint) const {
    const std::string what = "joint '" + joint.name + "' ";
    const bool fixed = joint.type == urdf::Joint::FIXED;
    if (!fixed && joint.type != urdf::Joint::FLOATING && !moves(joint)) {
      // Other types urdfdom does not take.
      fail(what +
           "is planar; allowed: floating (a free body), fixed (a fixture), revolute, continuous, prismatic");
    }
    if (joint.mimic) fail(what + "mimics '" + joint.mimic->joint_name + "'; allowed: joints without mimic");
    if (model_.getLink(joint.child_link_name)->parent_joint.get() != &joint) {
      fail(what + "is a second parent of link '" + joint.child_link_name +
           "'; allowed: one joint to each link");
    }
    if (joint.parent_link_name == root_.name || moves(joint)) return;
    if (!fixed) {
      fail(what + "floats on '" + joint.parent_link_name + "'; allowed: floating joints on the root '" +
           root_.name + "'");
    }
    const urdf::JointSharedPtr above = model_.getLink(joint.parent_link_name)->parent_joint;
    if (above && above->type != urdf::Joint::FIXED) {
      fail(what + "is fixed to " + (moves(*above) ? "the body '" : "the free body '") +
           joint.parent_link_name + (moves(*above) ? "', which moves" : "'") +
           "; allowed: fixed joints on the root or on fixtures (a body may have several collision elements)");
    }
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw SceneError(file_ + ": " + text::one_line(what));
  }

  const std::string& file_;
  const urdf::ModelInterface& model_;
  const urdf::Link& root_;
};

}  // namespace

bool moves(const urdf::Joint& joint) {
  return joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::CONTINUOUS ||
         joint.type == urdf::Joint::PRISMATIC;
}

Pose to_pose(const urdf::Pose& pose) {
  const urdf::Rotation& q = pose.rotation;
  return {{pose.position.x, pose.position.y, pose.position.z}, Quaternion(q.w, q.x, q.y, q.z).normalized()};
}

std::vector<PlacedLink> place_links(const std::string& urdf_file, const UrdfDocument& document) {
  const Tree tree(urdf_file, document);
  std::vector<PlacedLink> placed;
  for (const urdf::LinkConstSharedPtr& link : document.links) {
    if (link != document.model->getRoot()) placed.push_back(tree.place(link));
  }
  return placed;
}

}  // namespace mrhi
