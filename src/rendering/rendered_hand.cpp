#include "mr_hand_interaction/rendering/rendered_hand.h"

#include <algorithm>

#include "hand_joints.h"
#include "mr_hand_interaction/collision/near_bodies.h"

namespace mrhi {
namespace {

constexpr int kShapingPasses = 12;     // push out and keep together, alternately
constexpr int kClearingPasses = 60;    // then push out alone until clear
constexpr double kFarthestPush = 0.1;  // that a joint is moved out of what the hand is in [m]
constexpr double kClear = 1e-6;        // deeper than this is pushed [m]

struct Push {
  double depth = 0.0;  // [m]
  double s = 0.5;
  Vector3 normal = Vector3::Zero();
};

/// The contact of this capsule and shape that tells which face it entered by, if it is inside.
const Contact* memory(const std::vector<Contact>& contacts, int slot, int capsule, int body, int shape) {
  for (const Contact& contact : contacts) {
    if (contact.key.hand == slot && contact.key.capsule == capsule && contact.key.body == body &&
        contact.key.shape == shape && contact.depth > 0.0) {
      return &contact;
    }
  }
  return nullptr;
}

class Renderer {
 public:
  Renderer(int slot, const ContactFinder& finder, const Scene& scene, const std::vector<BodyState>& bodies,
           const std::vector<Contact>& contacts, std::vector<int> near)
      : slot_(slot),
        finder_(finder),
        scene_(scene),
        bodies_(bodies),
        contacts_(contacts),
        near_(std::move(near)) {}

  /// Pushes every capsule out of what it is in; returns the deepest penetration found.
  double push_out(const Hand& hand, bool by_entry_face, JointNet& net) const {
    double deepest = 0.0;
    for (int capsule = 0; capsule < kCapsules; ++capsule) {
      if (!hand.has(capsule)) continue;
      for (const int body : near_) {
        for (int shape = 0; shape < shapes_of(body); ++shape) {
          const Push push = needed(net.capsule(capsule), capsule, body, shape, by_entry_face);
          deepest = std::max(deepest, push.depth);
          if (push.depth > kClear) net.push(capsule, push.s, push.depth * push.normal);
        }
      }
    }
    return deepest;
  }

  /// Neighbouring bones on either side of a thin body pull their joint to and fro: those that are still
  /// inside leave on their own.
  void clear_alone(Hand& hand) const {
    for (int index = 0; index < kCapsules; ++index) {
      Capsule& capsule = hand.capsules[static_cast<std::size_t>(index)];
      if (capsule.radius <= 0.0) continue;
      for (int pass = 0; pass < kClearingPasses; ++pass) {
        const Push push = deepest(capsule, index);
        if (push.depth <= kClear) break;
        capsule.start += push.depth * push.normal;
        capsule.end += push.depth * push.normal;
      }
    }
  }

 private:
  Push deepest(const Capsule& capsule, int index) const {
    Push deepest;
    for (const int body : near_) {
      for (int shape = 0; shape < shapes_of(body); ++shape) {
        const Push push = needed(capsule, index, body, shape, false);
        if (push.depth > deepest.depth) deepest = push;
      }
    }
    return deepest;
  }

  int shapes_of(int body) const {
    return static_cast<int>(scene_.bodies[static_cast<std::size_t>(body)].shapes.size());
  }

  Push needed(const Capsule& capsule, int index, int body, int shape, bool by_entry_face) const {
    const auto b = static_cast<std::size_t>(body);
    const double reach = scene_.bodies[b].bounding_radius + capsule.radius;
    const double half = 0.5 * (capsule.end - capsule.start).norm();
    const Pose& pose = bodies_[b].pose;
    if ((capsule.centre() - pose.position).norm() > reach + half) return {};
    const auto features = finder_.closest(capsule, body, shape, pose, 0.0);
    if (!features || features->distance >= 0.0) return {};
    Push push{-features->distance, features->axis_parameter, features->normal};
    const Contact* contact = by_entry_face ? memory(contacts_, slot_, index, body, shape) : nullptr;
    if (contact != nullptr && contact->normal.dot(features->normal) < 0.5) {
      const Vector3& n = contact->normal;
      push.normal = n;
      push.s = n.dot(capsule.end - capsule.start) > 0.0 ? 0.0 : 1.0;
      push.depth = std::max(0.0, n.dot(contact->point - capsule.axis_point(push.s)) + capsule.radius);
    }
    return push;
  }

  int slot_;
  const ContactFinder& finder_;
  const Scene& scene_;
  const std::vector<BodyState>& bodies_;
  const std::vector<Contact>& contacts_;
  const std::vector<int> near_;
};

}  // namespace

RenderedHand render_hand(const Hand& tracked, int slot, const ContactFinder& finder, const Scene& scene,
                         const std::vector<BodyState>& bodies, const std::vector<Contact>& contacts) {
  RenderedHand rendered;
  rendered.hand = tracked;
  for (const Contact& contact : contacts) {
    if (contact.key.hand == slot && contact.touching()) rendered.touching[contact.key.capsule] = true;
  }
  const Renderer renderer(slot, finder, scene, bodies, contacts,
                          near_bodies(tracked, scene, bodies, kFarthestPush));
  JointNet net(tracked);
  if (renderer.push_out(tracked, true, net) <= kClear) return rendered;
  for (int pass = 0; pass < kShapingPasses; ++pass) {
    net.restore_lengths();
    renderer.push_out(tracked, true, net);
  }
  for (int pass = 0; pass < kClearingPasses && renderer.push_out(tracked, false, net) > kClear; ++pass) {
  }
  rendered.hand = net.apply(tracked);
  renderer.clear_alone(rendered.hand);
  return rendered;
}

double deepest_penetration(const Hand& hand, const ContactFinder& finder, const Scene& scene,
                           const std::vector<BodyState>& bodies) {
  double deepest = 0.0;
  const std::vector<int> near = near_bodies(hand, scene, bodies, 0.0);
  for (int capsule = 0; capsule < kCapsules; ++capsule) {
    if (!hand.has(capsule)) continue;
    for (const int body : near) {
      const auto b = static_cast<std::size_t>(body);
      for (int shape = 0; shape < static_cast<int>(scene.bodies[b].shapes.size()); ++shape) {
        const auto features = finder.closest(hand.capsules[static_cast<std::size_t>(capsule)], body, shape,
                                             bodies[b].pose, 0.0);
        if (features) deepest = std::max(deepest, -features->distance);
      }
    }
  }
  return deepest;
}

}  // namespace mrhi
