#include "grasp.h"

#include <algorithm>
#include <optional>

namespace mrhi {
namespace {

constexpr double kHoverBegins = 0.03;  // [m]
/// What is left of the pushes when they are added as vectors, relative to their sum as numbers: at most this
/// for a grasp to begin, and to last.
constexpr double kBalanced = 0.6, kStillBalanced = 0.75;

struct Pressing {
  Vector3 sum = Vector3::Zero();
  double total = 0.0;
  int capsules = 0;
  bool struck = false;
};

template <typename IsOfIt>
Pressing pressing(int slot, const std::vector<Contact>& contacts, IsOfIt&& is_of_it) {
  Pressing result;
  int last_capsule = -1;
  for (const Contact& contact : contacts) {
    if (contact.key.hand != slot || !is_of_it(contact.key.body)) continue;
    if (contact.impulse != Vector3::Zero()) result.struck = true;
    if (!contact.touching()) continue;
    result.sum += contact.share * contact.depth * contact.normal;
    result.total += contact.share * contact.depth;
    if (contact.key.capsule != last_capsule) ++result.capsules;
    last_capsule = contact.key.capsule;
  }
  return result;
}

bool is_grasped(const Pressing& press, double balanced) {
  return press.capsules >= 2 && press.sum.norm() <= balanced * press.total;
}

/// The joint that a body hangs on.
const Joint* joint_of(const Scene& scene, int body) {
  const auto is_it = [body](const Joint& joint) { return joint.child == body; };
  const auto found = std::find_if(scene.joints.begin(), scene.joints.end(), is_it);
  return found == scene.joints.end() ? nullptr : &*found;
}

/// The free body that all hangs on which it hangs together with; nothing of what hangs on the world or on a
/// fixture.
std::optional<int> floating_root(const Scene& scene, int body) {
  while (const Joint* joint = joint_of(scene, body)) {
    if (joint->parent == Joint::kWorld) return {};
    body = joint->parent;
  }
  if (scene.bodies[static_cast<std::size_t>(body)].fixed) return {};
  return body;
}

/// Tongs are grasped by both their arms, each of which is pressed from one side.
bool grasps_whole(const Scene& scene, int slot, int body, const std::vector<Contact>& contacts,
                  double balanced) {
  const std::optional<int> root = floating_root(scene, body);
  const auto is_of_it = [&](int other) { return floating_root(scene, other) == root; };
  return root && is_grasped(pressing(slot, contacts, is_of_it), balanced);
}

bool is_near(const Hand& hand, int body, const ContactFinder& finder, const Body& shape_of, const Pose& pose,
             double distance) {
  for (int c = 0; c < kCapsules; ++c) {
    const Capsule& capsule = hand.capsules[static_cast<std::size_t>(c)];
    if (capsule.radius <= 0.0) continue;
    const double reach = shape_of.bounding_radius + capsule.radius + distance;
    if ((capsule.centre() - pose.position).norm() > reach + 0.5 * (capsule.end - capsule.start).norm())
      continue;
    for (int shape = 0; shape < static_cast<int>(shape_of.shapes.size()); ++shape) {
      if (finder.closest(capsule, body, shape, pose, distance)) return true;
    }
  }
  return false;
}

}  // namespace

InteractionLevel seen_level(const Hand& hand, int slot, int body, const ContactFinder& finder,
                            const Scene& scene, const Pose& body_pose, const std::vector<Contact>& contacts,
                            InteractionLevel before) {
  const Pressing press = pressing(slot, contacts, [body](int other) { return other == body; });
  const double balanced = before == InteractionLevel::grasp ? kStillBalanced : kBalanced;
  if (is_grasped(press, balanced)) return InteractionLevel::grasp;
  if (!scene.joints.empty() && press.capsules >= 1 && grasps_whole(scene, slot, body, contacts, balanced))
    return InteractionLevel::grasp;
  if (press.capsules >= 1 || press.struck) return InteractionLevel::contact;
  const double distance = before == InteractionLevel::none ? kHoverBegins : kHoverEnds;
  const Body& shape_of = scene.bodies[static_cast<std::size_t>(body)];
  return is_near(hand, body, finder, shape_of, body_pose, distance) ? InteractionLevel::hover
                                                                    : InteractionLevel::none;
}

}  // namespace mrhi
