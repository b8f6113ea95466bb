#include "mr_hand_interaction/rendering/rendered_hand.h"

#include <algorithm>

#include "../collision/near_bodies.h"
#include "renderer.h"
#include "return_home.h"

namespace mrhi {
namespace {

constexpr double kFarthestPush = 0.1;  // bodies nearer than this may be met while the hand is pushed out [m]
constexpr double kFromNowhere = 1.0;   // that a hand is said to have moved that was not there before [m]
/// A hand stays this long behind a body that the tracked hand has passed through, without coming nearer by as
/// much as this [m].
constexpr Nanoseconds kStaysBehind = 1'000'000'000;
constexpr double kProgress = 0.001;

}  // namespace

HandRenderer::HandRenderer(const Scene& scene, const ContactFinder& finder)
    : impl_(std::make_unique<Impl>(scene, finder)) {}
HandRenderer::~HandRenderer() = default;

void HandRenderer::render(const HandTrack& track, int slot, Nanoseconds stamp,
                          const std::vector<BodyState>& bodies, const std::vector<Contact>& contacts,
                          Interaction* interactions, HandOffset& offset, RenderedHand& rendered) {
  Impl& impl = *impl_;
  rendered.hand = track.current;
  rendered.touching.fill(false);
  for (const Contact& contact : contacts) {
    if (contact.key.hand == slot && contact.touching()) rendered.touching[contact.key.capsule] = true;
  }
  if (track.appeared) offset = HandOffset();
  ClearanceFinder::Setting setting{track.current, slot, bodies, contacts, nullptr, 0.0, interactions};
  const bool away = !offset.zero();
  const double margin = away ? offset.shift.norm() + kFarthestPush : kAhead;
  bool near = impl.finder.begin(setting, margin);
  if (impl.finder.shown_in_any() && impl.end_shown_in(track, offset, interactions))
    near = impl.finder.begin(setting, margin);
  HandOffset now;
  if (away || near) {
    impl.chain.begin(track.current, lag_returning(offset, stamp));
    impl.clearances.clear();
    now = returning(offset, stamp, impl.chain);
    impl.chain.place(now, rendered.hand);
  }
  const HandOffset reference = now;
  const double least = near ? impl.finder.find(rendered.hand, setting, kAhead, impl.clearances) : 0.0;
  const bool pushed = least < -kClear;
  if (pushed || away) impl.look_back(track, stamp, offset, setting);
  if (pushed) impl.push_out(setting, offset, least, now, rendered.hand);
  if (setting.shown_before != nullptr) impl.keep_pace(setting, offset, reference, now, rendered.hand);
  if (!pushed) {
    now.left = 0.0;
  } else if (impl.left_behind(setting, stamp, now)) {
    now = HandOffset();
  }
  if (now.zero()) rendered.hand = track.current;
  now.stamp = stamp;
  offset = now;
}

bool HandRenderer::Impl::end_shown_in(const HandTrack& track, const HandOffset& last,
                                      Interaction* interactions) {
  const Hand& from = track.appeared ? track.current : track.previous;
  Hand shown = from;
  chain_before.begin(from, last.lag);
  chain_before.place(last, shown);
  return finder.end_shown_in(shown, interactions);
}

/// At the frame before.
void HandRenderer::Impl::look_back(const HandTrack& track, Nanoseconds stamp, const HandOffset& last,
                                   ClearanceFinder::Setting& setting) {
  finder.begin(setting, last.shift.norm() + kFarthestPush);
  setting.moved = kFromNowhere;
  if (track.appeared) return;
  before = track.previous;
  chain_before.begin(track.previous, last.lag);
  chain_before.place(last, before);
  setting.shown_before = &before;
  tracked_way = farthest_joint(track.previous, track.current);
  elapsed = to_seconds(stamp - last.stamp);
  setting.moved = tracked_way + finder.fastest_body(setting.bodies) * elapsed;
}

/// True once the tracked hand has been clear of everything for a while and the rendered one has not come any
/// nearer to it.
bool HandRenderer::Impl::left_behind(const ClearanceFinder::Setting& setting, Nanoseconds stamp,
                                     HandOffset& offset) {
  const auto holds = [&](const Contact& contact) {
    return contact.key.hand == setting.slot && contact.touching();
  };
  const bool held = std::any_of(setting.contacts.begin(), setting.contacts.end(), holds);
  if (held || !finder.clear(setting.tracked)) {
    offset.left = 0.0;
    return false;
  }
  const double left = way(HandOffset(), offset);
  if (offset.left == 0.0 || left < offset.left - kProgress) {
    offset.left = left;
    offset.left_since = stamp;
  }
  return stamp - offset.left_since >= kStaysBehind;
}

double deepest_penetration(const Hand& hand, const ContactFinder& finder, const Scene& scene,
                           const std::vector<BodyState>& bodies, const Interaction* interactions) {
  double deepest = 0.0;
  const std::vector<int> near = near_bodies(hand, scene, bodies, 0.0);
  for (int capsule = 0; capsule < kCapsules; ++capsule) {
    if (!hand.has(capsule)) continue;
    for (const int body : near) {
      const auto b = static_cast<std::size_t>(body);
      if (interactions[b].shown_in) continue;
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
