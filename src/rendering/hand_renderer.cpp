#include "hand_renderer.h"

#include <algorithm>
#include <cmath>

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

/// Around the tracked hand, in which bodies are looked for [m].
double margin(const HandOffset& offset) {
  return offset.zero() ? kAhead : offset.shift.norm() + kFarthestPush;
}

/// To the bit: what is placed anew from the same numbers is the same.
bool same_place(const Hand& a, const Hand& b) {
  const auto same = [](const Capsule& x, const Capsule& y) {
    return x.radius == y.radius && x.start == y.start && x.end == y.end;
  };
  return a.palm.position == b.palm.position && a.wrist == b.wrist &&
         a.palm.orientation.coeffs() == b.palm.orientation.coeffs() &&
         std::equal(a.capsules.begin(), a.capsules.end(), b.capsules.begin(), same);
}

bool same_way(const HandOffset& a, const HandOffset& b) {
  const auto same = [](const FingerOffset& x, const FingerOffset& y) { return (x == y).all(); };
  return a.shift == b.shift && a.lag.whole.coeffs() == b.lag.whole.coeffs() &&
         a.lag.frame.coeffs() == b.lag.frame.coeffs() &&
         std::equal(a.fingers.begin(), a.fingers.end(), b.fingers.begin(), same);
}

}  // namespace

/// By the share of each contact. The mean, by shares w, as it goes: m <- m + w / sum w (x - m).
void note_touches(const std::vector<Contact>& contacts, int slot, RenderedHand& rendered) {
  rendered.touching.fill(false);
  std::array<double, kCapsules> shares{};
  for (const Contact& contact : contacts) {
    if (contact.key.hand != slot || !contact.touching()) continue;
    const std::size_t c = contact.key.capsule;
    Pressed& pressed = rendered.pressed[c];
    if (!rendered.touching[c]) pressed = Pressed();
    rendered.touching[c] = true;
    pressed.force += std::abs(contact.normal.dot(contact.force));
    shares[c] += contact.share;
    if (shares[c] > 0.0) pressed.point += contact.share / shares[c] * (contact.point - pressed.point);
  }
}

HandRenderer::HandRenderer(const Scene& scene, const ContactFinder& finder)
    : impl_(std::make_unique<Impl>(scene, finder)) {}
HandRenderer::~HandRenderer() = default;

void HandRenderer::render(const HandTrack& track, int slot, Nanoseconds stamp,
                          const std::vector<BodyState>& bodies, const std::vector<Contact>& contacts,
                          Interaction* interactions, HandOffset& offset, RenderedHand& rendered) {
  Impl& impl = *impl_;
  note_touches(contacts, slot, rendered);
  if (track.appeared) offset = HandOffset();
  ClearanceFinder::Setting setting{track.current, slot, bodies, contacts, nullptr, 0.0, interactions};
  const bool near = impl.begin(setting, track, offset);
  HandOffset now = impl.keep_outside(setting, track, stamp, offset, near, rendered.hand);
  for (const bool fixtures : {false, true}) {
    const bool stays_behind = impl.left_behind(setting, stamp, now);
    if (impl.leap <= kTolerated && !stays_behind) break;
    if (!impl.show_in(fixtures, interactions)) continue;
    const bool others = impl.finder.begin(setting, margin(offset));
    now = impl.keep_outside(setting, track, stamp, offset, others, rendered.hand);
  }
  if (now.zero()) rendered.hand = track.current;
  now.stamp = stamp;
  offset = now;
  if (!now.zero()) impl.kept[static_cast<std::size_t>(slot)] = {true, track.current, rendered.hand, offset};
}

/// The hand outside of all bodies but those that it is shown in; the finder has begun with what is `near` it.
HandOffset HandRenderer::Impl::keep_outside(ClearanceFinder::Setting& setting, const HandTrack& track,
                                            Nanoseconds stamp, const HandOffset& offset, bool near,
                                            Hand& placed) {
  placed = track.current;
  setting.shown_before = nullptr;
  setting.moved = 0.0;
  const bool away = !offset.zero();
  HandOffset now;
  clearances.clear();
  if (away || near) {
    chain.begin(track.current, lag_returning(offset, stamp));
    now = returning(offset, stamp, chain);
    chain.place(now, placed);
  }
  const HandOffset reference = now;
  const double least = near ? finder.find(placed, setting, kAhead, clearances) : 0.0;
  pushed = least < -kClear;
  leap = 0.0;
  if (pushed || away) look_back(track, stamp, offset, setting);
  if (pushed) push_out(setting, offset, least, now, placed);
  if (setting.shown_before != nullptr) keep_pace(setting, offset, reference, now, placed);
  return now;
}

/// Bodies and joints leave the hand no way out that is not a leap: it is shown in them until it is clear of
/// them, as in a body that appears. True if there are such.
bool HandRenderer::Impl::show_in(bool fixtures, Interaction* interactions) const {
  bool any = false;
  for (const Clearance& clearance : clearances) {
    const bool fixed = finder.fixed(clearance.key.body);
    if (fixed && !fixtures) continue;
    any = any || !interactions[clearance.key.body].shown_in;
    interactions[clearance.key.body].shown_in = true;
  }
  return any;
}

/// Finds what is near the hand, but for what it is shown in. That ends with what the hand, as it was shown,
/// was clear of.
bool HandRenderer::Impl::begin(const ClearanceFinder::Setting& setting, const HandTrack& track,
                               const HandOffset& last) {
  const bool near = finder.begin(setting, margin(last));
  if (!finder.shown_in_any()) return near;
  const Hand& from = track.appeared ? track.current : track.previous;
  Hand shown = from;
  chain_before.begin(from, last.lag);
  chain_before.place(last, shown);
  finder.end_shown_in(shown, setting.interactions);
  return finder.begin(setting, margin(last));
}

/// At the frame before.
///
/// `moved` bounds what can have come into each other since: the farthest joint's way and the fastest body's,
/// |v| + |w| R times the time.
void HandRenderer::Impl::look_back(const HandTrack& track, Nanoseconds stamp, const HandOffset& offset,
                                   ClearanceFinder::Setting& setting) {
  if (offset.zero()) finder.begin(setting, kFarthestPush);
  setting.moved = kFromNowhere;
  if (track.appeared) return;
  const Shown& known = kept[static_cast<std::size_t>(setting.slot)];
  tracked_before = track.previous;
  offset_before = offset;
  chain_before_set = false;
  if (known.known && same_way(known.offset, offset_before) && same_place(known.tracked, tracked_before)) {
    before = known.hand;
  } else {
    place_before();
  }
  setting.shown_before = &before;
  tracked_way = farthest_joint(track.previous, track.current);
  elapsed = to_seconds(stamp - offset_before.stamp);
  setting.moved = tracked_way + finder.fastest_body(setting.bodies) * elapsed;
}

void HandRenderer::Impl::place_before() {
  before = tracked_before;
  chain_before.begin(tracked_before, offset_before.lag);
  chain_before.place(offset_before, before);
  chain_before_set = true;
}

/// As it was placed then.
FingerChain& HandRenderer::Impl::finger_before(int index) {
  if (!chain_before_set) place_before();
  return chain_before.finger(index);
}

/// True once the tracked hand has been clear of everything for a while and the rendered one has not come any
/// nearer to it.
bool HandRenderer::Impl::left_behind(const ClearanceFinder::Setting& setting, Nanoseconds stamp,
                                     HandOffset& offset) {
  const auto holds = [&](const Contact& contact) {
    return contact.key.hand == setting.slot && contact.touching();
  };
  const bool held = std::any_of(setting.contacts.begin(), setting.contacts.end(), holds);
  if (!pushed || held || !finder.clear(setting.tracked)) {
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
