#include "mr_hand_interaction/rendering/rendered_hand.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "clearance_finder.h"
#include "mr_hand_interaction/collision/near_bodies.h"
#include "pace.h"
#include "return_home.h"

namespace mrhi {
namespace {

constexpr int kMaxPasses = 12;
constexpr double kClear = 2e-5;        // gaps larger than -this are clear [m]
constexpr double kTolerated = 1e-4;    // deeper than this after all passes, the next means are tried [m]
constexpr double kAhead = 0.0015;      // surfaces nearer than this are kept off before they are met [m]
constexpr double kFarthestPush = 0.1;  // bodies nearer than this may be met while the hand is pushed out [m]
constexpr double kSwing = 0.0005;      // that a fingertip may turn by in a frame, and this share of what hand
constexpr double kSwingShare = 0.8;    // and bodies move: the rest is the whole hand's to give way [m]
constexpr double kAnyway = 1.0;        // for a hand that comes from nowhere [m]
constexpr double kPace = 0.0018;       // that a joint may go beyond what hand and bodies move [m]
constexpr double kSmallStep = 0.0003;  // a pass that moves no joint farther is not looked at again [m]
/// A hand stays this long behind a body that the tracked hand has passed through, without coming nearer by as
/// much as this [m].
constexpr Nanoseconds kStaysBehind = 1'000'000'000;
constexpr double kProgress = 0.001;

}  // namespace

struct HandRenderer::Impl {
  Impl(const Scene& scene, const ContactFinder& contact_finder) : finder(scene, contact_finder) {
    clearances.reserve(128);
  }

  void look_back(const HandTrack& track, Nanoseconds stamp, const HandOffset& last,
                 ClearanceFinder::Setting& setting);
  void push_out(const ClearanceFinder::Setting& setting, const HandOffset& last, double least,
                HandOffset& offset, Hand& placed);
  void keep_pace(const HandTrack& track, const ClearanceFinder::Setting& setting, const HandOffset& last,
                 const HandOffset& reference, HandOffset& offset, Hand& placed);
  void keep_out(const ClearanceFinder::Setting& setting, const HandOffset& reference,
                const OffsetBounds& bounds, HandOffset& offset, Hand& placed);
  double settle(const ClearanceFinder::Setting& setting, const HandOffset& reference,
                const OffsetBounds& bounds, HandOffset& offset, Hand& placed, const Pace* pace = nullptr);
  void begin_anew(const ClearanceFinder::Setting& setting, const HandOffset& reference, HandOffset& offset,
                  Hand& placed);
  HandOffset staying(const ClearanceFinder::Setting& setting, const HandOffset& last);
  void linearise(const Hand& placed);
  void shift_out(const ClearanceFinder::Setting& setting, HandOffset& offset, Hand& placed);
  double way(const HandOffset& from, const HandOffset& to);
  bool left_behind(const ClearanceFinder::Setting& setting, Nanoseconds stamp, HandOffset& offset);

  ClearanceFinder finder;
  HandChain chain, chain_before;
  std::vector<Clearance> clearances;
  Hand before;
};

HandRenderer::HandRenderer(const Scene& scene, const ContactFinder& finder)
    : impl_(std::make_unique<Impl>(scene, finder)) {}
HandRenderer::~HandRenderer() = default;

void HandRenderer::render(const HandTrack& track, int slot, Nanoseconds stamp,
                          const std::vector<BodyState>& bodies, const std::vector<Contact>& contacts,
                          HandOffset& offset, RenderedHand& rendered) {
  Impl& impl = *impl_;
  rendered.hand = track.current;
  rendered.touching.fill(false);
  for (const Contact& contact : contacts) {
    if (contact.key.hand == slot && contact.touching()) rendered.touching[contact.key.capsule] = true;
  }
  if (track.appeared) offset = HandOffset();
  ClearanceFinder::Setting setting{track.current, slot, bodies, contacts, nullptr, 0.0};
  const bool away = !offset.zero();
  const bool near = impl.finder.begin(setting, away ? kFarthestPush : kAhead);
  HandOffset now;
  if (away || near) {
    impl.chain.begin(track.current);
    impl.clearances.clear();
    now = returning(offset, stamp, impl.chain);
    impl.chain.place(now, rendered.hand);
  }
  const HandOffset reference = now;
  const double least = near ? impl.finder.find(rendered.hand, setting, kAhead, impl.clearances) : 0.0;
  const bool pushed = least < -kClear;
  if (pushed || away) impl.look_back(track, stamp, offset, setting);
  if (pushed) impl.push_out(setting, offset, least, now, rendered.hand);
  if (setting.shown_before != nullptr) impl.keep_pace(track, setting, offset, reference, now, rendered.hand);
  if (!pushed) {
    now.left = 0.0;
  } else if (impl.left_behind(setting, stamp, now)) {
    now = HandOffset();
  }
  if (now.zero()) rendered.hand = track.current;
  now.stamp = stamp;
  offset = now;
}

/// At the frame before.
void HandRenderer::Impl::look_back(const HandTrack& track, Nanoseconds stamp, const HandOffset& last,
                                   ClearanceFinder::Setting& setting) {
  finder.begin(setting, kFarthestPush);
  setting.moved = kAnyway;
  if (track.appeared) return;
  before = track.previous;
  chain_before.begin(track.previous);
  chain_before.place(last, before);
  setting.shown_before = &before;
  setting.moved = farthest_joint(track.previous, track.current) +
                  finder.fastest_body(setting.bodies) * to_seconds(stamp - last.stamp);
}

void HandRenderer::Impl::push_out(const ClearanceFinder::Setting& setting, const HandOffset& last,
                                  double least, HandOffset& offset, Hand& placed) {
  const HandOffset reference = offset;
  if (least < -ClearanceFinder::kShallow) begin_anew(setting, reference, offset, placed);
  keep_out(setting, reference, {last, kSwingShare * setting.moved + kSwing}, offset, placed);
}

/// A hand that is held away from the axis about which the tracked one turns swings farther: where the bodies
/// leave room, it gives way.
void HandRenderer::Impl::keep_pace(const HandTrack& track, const ClearanceFinder::Setting& setting,
                                   const HandOffset& last, const HandOffset& reference, HandOffset& offset,
                                   Hand& placed) {
  const Pace pace(before, farthest_joint(track.previous, track.current) + kPace);
  double least_beyond = pace.beyond(placed);
  if (least_beyond <= 0.0) return;
  HandOffset best = offset;
  const auto in_step = [&](const HandOffset& nearest_to, double swing) {
    pace.keep(placed, clearances);
    settle(setting, nearest_to, {last, swing}, offset, placed, &pace);
    Pace::forget(clearances);
    const double beyond = pace.beyond(placed);
    if (beyond >= least_beyond || finder.find(placed, setting, kAhead, clearances) < -kTolerated) return;
    least_beyond = beyond;
    best = offset;
  };
  in_step(reference, kSwingShare * setting.moved + kSwing);
  if (least_beyond > kTolerated) {
    const HandOffset stay = staying(setting, last);
    begin_anew(setting, stay, offset, placed);
    in_step(stay, kAnyway);
  }
  offset = best;
  chain.place(offset, placed);
}

/// The hand does not move from where it was shown.
HandOffset HandRenderer::Impl::staying(const ClearanceFinder::Setting& setting,
                                       const HandOffset& last) {
  HandOffset stay = last;
  stay.shift = before.palm.position - setting.tracked.palm.position;
  for (int f = 0; f < kFingers; ++f)
    stay.fingers[static_cast<std::size_t>(f)] = chain.finger(f).like(before, chain_before.finger(f));
  return stay;
}

void HandRenderer::Impl::keep_out(const ClearanceFinder::Setting& setting, const HandOffset& reference,
                                  const OffsetBounds& bounds, HandOffset& offset, Hand& placed) {
  if (settle(setting, reference, bounds, offset, placed) > -kTolerated) return;
  begin_anew(setting, reference, offset, placed);
  if (settle(setting, reference, {bounds.before, kAnyway}, offset, placed) > -kTolerated) return;
  if (setting.shown_before != nullptr) {
    const HandOffset stay = staying(setting, bounds.before);
    begin_anew(setting, stay, offset, placed);
    if (settle(setting, stay, {bounds.before, kAnyway}, offset, placed) > -kTolerated) return;
  }
  begin_anew(setting, reference, offset, placed);
  shift_out(setting, offset, placed);
}

/// Sequential quadratic programming: gaps are found where the hand is and linearised. Returns the least gap
/// [m].
double HandRenderer::Impl::settle(const ClearanceFinder::Setting& setting, const HandOffset& reference,
                                  const OffsetBounds& bounds, HandOffset& offset, Hand& placed,
                                  const Pace* pace) {
  double least = 0.0;
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    linearise(placed);
    const HandOffset from = offset;
    const double expected = solve_offset(reference, bounds, chain, clearances, offset);
    chain.place(offset, placed);
    if (expected > -kClear && way(from, offset) < kSmallStep) return expected;
    least = finder.find(placed, setting, kAhead, clearances);
    if (pace != nullptr) least = std::min(least, pace->keep(placed, clearances));
    if (least > -kClear) return least;
  }
  return least;
}

void HandRenderer::Impl::begin_anew(const ClearanceFinder::Setting& setting, const HandOffset& reference,
                                    HandOffset& offset, Hand& placed) {
  offset = reference;
  chain.place(offset, placed);
  clearances.clear();
  finder.find(placed, setting, kAhead, clearances);
}

void HandRenderer::Impl::linearise(const Hand& placed) {
  for (Clearance& clearance : clearances) {
    const int capsule = clearance.key.capsule;
    const int finger_index = HandChain::finger_that_moves(capsule);
    clearance.by_shift << clearance.normal.array(), 0.0;
    if (finger_index < 0) continue;
    const Vector3 point = placed.capsules[clearance.key.capsule].axis_point(clearance.s);
    clearance.by_finger = chain.finger(finger_index).gradient(bone_of(capsule), point, clearance.normal);
  }
}

double HandRenderer::Impl::way(const HandOffset& from, const HandOffset& to) {
  double farthest = 0.0;
  for (int f = 0; f < kFingers; ++f) {
    const auto i = static_cast<std::size_t>(f);
    const FingerOffset change = to.fingers[i] - from.fingers[i];
    if (!(change == 0.0).all()) farthest = std::max(farthest, chain.finger(f).way(change));
  }
  return farthest + (to.shift - from.shift).norm();
}

/// The clearances contradict each other: the hand as it is goes as a whole to that side of the deepest body
/// which is the nearest.
void HandRenderer::Impl::shift_out(const ClearanceFinder::Setting& setting, HandOffset& offset,
                                   Hand& placed) {
  constexpr int kMaxBodies = 4;
  for (int attempt = 0; attempt < kMaxBodies; ++attempt) {
    const auto deepest =
        std::min_element(clearances.begin(), clearances.end(),
                         [](const Clearance& a, const Clearance& b) { return a.gap < b.gap; });
    Vector3 way = Vector3::Zero();
    double least = std::numeric_limits<double>::max();
    for (const Clearance& side : clearances) {
      if (side.key.body != deepest->key.body || side.key.shape != deepest->key.shape) continue;
      double reach = std::numeric_limits<double>::max();
      for (const Capsule& capsule : placed.capsules) {
        if (capsule.radius <= 0.0) continue;
        const double lowest = std::min(side.normal.dot(capsule.start), side.normal.dot(capsule.end));
        reach = std::min(reach, lowest - capsule.radius - side.height);
      }
      if (-reach >= least) continue;
      least = -reach;
      way = -reach * side.normal;
    }
    offset.shift += way;
    chain.place(offset, placed);
    clearances.clear();
    if (finder.find(placed, setting, kAhead, clearances) > -kTolerated) return;
  }
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
