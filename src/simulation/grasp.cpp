#include "grasp.h"

#include <algorithm>
#include <optional>

#include "mr_hand_interaction/scene/joint.h"

namespace mrhi {
namespace {

/// Distance at which hovering begins [m].
constexpr double kHoverBegins = 0.03;
/// Largest ratio of the loads' vector sum to the sum of their norms with which a grasp begins, and lasts.
constexpr double kMaxImbalance = 0.6, kMaxLastingImbalance = 0.75;

/// Normal loads of contacts, by their depths and the strength of the fingers. A finger that has gone through
/// the object applies no more force than one that complies at its surface.
struct Load {
  Vector3 sum = Vector3::Zero();
  double total = 0.0;
  int capsules = 0;
  bool struck = false;
};

template <typename Counts>
Load load_of(const Scene& scene, const std::vector<Contact>& contacts, Counts&& counts) {
  Load load;
  int last_capsule = -1;
  for (const Contact& contact : contacts) {
    if (!counts(contact.key)) continue;
    if (contact.impulse != Vector3::Zero()) load.struck = true;
    if (!contact.touching()) continue;
    const double stiffness = contact.share * scene.bodies[contact.key.body].material.stiffness;
    const double normal = std::min(stiffness * contact.depth, contact.strength);
    load.sum += normal * contact.normal;
    load.total += normal;
    const int capsule = kCapsules * contact.key.hand + contact.key.capsule;
    if (capsule != last_capsule) ++load.capsules;
    last_capsule = capsule;
  }
  return load;
}

bool is_balanced(const Load& load, double max_imbalance) {
  return load.capsules >= 2 && load.sum.norm() <= max_imbalance * load.total;
}

/// True if the loads of the hand on an object balance, or those of all hands while those of the others do
/// not: each side of a box that two hands lift.
template <typename OfObject>
bool grasps(const Scene& scene, int slot, const std::vector<Contact>& contacts, double max_imbalance,
            const OfObject& of_object) {
  const auto balances = [&](const auto& counts) {
    return is_balanced(load_of(scene, contacts, counts), max_imbalance);
  };
  if (balances([&](const ContactKey& key) { return key.hand == slot && of_object(key); })) return true;
  return balances(of_object) &&
         !balances([&](const ContactKey& key) { return key.hand != slot && of_object(key); });
}

bool is_near(const Hand& hand, int body, const ContactFinder& finder, const Body& shape_of, const Pose& pose,
             double distance) {
  for (int c = 0; c < kCapsules; ++c) {
    const Capsule& capsule = hand.capsules[c];
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
  const auto of_hand = [&](const ContactKey& key) { return key.hand == slot && key.body == body; };
  const Load load = load_of(scene, contacts, of_hand);
  const double max_imbalance = before == InteractionLevel::grasp ? kMaxLastingImbalance : kMaxImbalance;
  // A linkage is grasped as a whole: both arms of tongs, each loaded from one side.
  const std::optional<int> root = scene.joints.empty() ? std::nullopt : floating_root(scene, body);
  const auto of_body = [&](const ContactKey& key) { return key.body == body; };
  const auto of_linkage = [&](const ContactKey& key) { return floating_root(scene, key.body) == root; };
  if (load.capsules >= 1 && (grasps(scene, slot, contacts, max_imbalance, of_body) ||
                             (root && grasps(scene, slot, contacts, max_imbalance, of_linkage))))
    return InteractionLevel::grasp;
  if (load.capsules >= 1 || load.struck) return InteractionLevel::contact;
  const double distance = before == InteractionLevel::none ? kHoverBegins : kHoverEnds;
  const Body& shape_of = scene.bodies[body];
  return is_near(hand, body, finder, shape_of, body_pose, distance) ? InteractionLevel::hover
                                                                    : InteractionLevel::none;
}

}  // namespace mrhi
