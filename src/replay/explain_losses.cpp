#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "explain.h"

namespace mrhi {
namespace {

constexpr double kWindow = 0.6;      // before an object is let go, in which its cause is sought [s]
constexpr double kAttempt = 0.1;     // shorter touches are no attempts to grasp [s]
constexpr double kTracking = 0.5;    // a hand may be kept that long after it was seen last [s]
constexpr double kBlow = 0.05;       // change of the object's speed by another that counts [m/s]
constexpr double kBlowWindow = 0.4;  // [s]
constexpr double kOpened = 0.003;    // of the mean distance of the fingertips from their middle [m]
constexpr double kSlippery = 0.4;    // static friction below that of skin (docs/contact.md)
constexpr double kFull = 0.98;       // share of the limit that counts as all of it

using Samples = std::vector<ObjectSample>;
using Hands = std::vector<HandSample>;

/// One stay of an object with a hand: samples [first, last], the last in which they touch being `touched`.
struct Stay {
  const std::string& name;
  const ObjectStory& object;
  std::uint32_t hand_id;
  bool grasped;
  std::size_t first, touched, last;

  double time(std::size_t i) const { return object.samples[i].time; }
  /// Where the search for its cause begins.
  std::size_t window() const {
    std::size_t i = touched;
    while (i > first && time(touched) - time(i - 1) <= kWindow) --i;
    return i;
  }
};

std::vector<FingerTouch> touches_of(const ObjectSample& sample, std::uint32_t hand_id) {
  std::vector<FingerTouch> touches;
  for (const FingerTouch& touch : sample.fingers)
    if (touch.hand_id == hand_id) touches.push_back(touch);
  return touches;
}

double push_of(const std::vector<FingerTouch>& touches) {
  double push = 0.0;
  for (const FingerTouch& touch : touches) push += std::max(touch.normal, 0.0);
  return push;
}

std::string number(double value, const char* unit = "") {
  char text[40];
  std::snprintf(text, sizeof text, "%.3g%s", value, unit);
  return text;
}

std::string seconds(double time) {
  char text[40];
  std::snprintf(text, sizeof text, "%.2f s", time);
  return text;
}

std::string finger_text(int finger) {
  return finger == kFingers ? "the palm" : std::string("the ") + finger_name(capsule_index(finger, 3));
}

// Tracking.

bool tracking_was_lost(const Stay& stay, const Hands& hand) {
  const double from = stay.time(stay.touched) - kTracking, until = stay.time(stay.last);
  const bool held = std::any_of(hand.begin(), hand.end(), [&](const HandSample& sample) {
    return sample.lost && sample.time >= from && sample.time <= until + 1e-9;
  });
  return held || hand.back().time < until - 1e-9;
}

// A blow: another free object that no hand touches changes its way near this one.

struct Blow {
  std::string by;
  double time = 0.0, speed = 0.0;
};

Blow blow_by(const Stay& stay, const std::string& other_name, const ObjectStory& other,
             const Vector3& gravity) {
  Blow blow;
  const Samples &ours = stay.object.samples, &theirs = other.samples;
  const double from = stay.time(stay.touched) - kBlowWindow, until = stay.time(stay.touched) + 0.02;
  for (std::size_t i = 1; i < theirs.size(); ++i) {
    const ObjectSample &now = theirs[i], &before = theirs[i - 1];
    if (now.time < from || now.time > until || !now.fingers.empty() || !before.fingers.empty()) continue;
    const auto our = std::lower_bound(ours.begin(), ours.end(), now.time,
                                      [](const ObjectSample& s, double time) { return s.time < time; });
    if (our == ours.end()) continue;
    const double reach = stay.object.radius + other.radius + 0.02;
    if ((our->position - now.position).norm() > reach + (now.velocity - before.velocity).norm() * 0.02)
      continue;
    const Vector3 change = now.velocity - before.velocity - gravity * (now.time - before.time);
    const double speed = other.mass * change.norm() / stay.object.mass;
    if (speed > blow.speed) blow = {other_name, now.time, speed};
  }
  return blow;
}

std::optional<Blow> worst_blow(const Stay& stay, const Explanation& story) {
  Blow worst;
  for (const auto& [name, other] : story.objects) {
    if (name == stay.name) continue;
    const Blow blow = blow_by(stay, name, other, story.gravity);
    if (blow.speed > worst.speed) worst = blow;
  }
  if (worst.speed < kBlow) return {};
  return worst;
}

// The hand opens.

/// Mean distance of the tips of the fingers that `used` names from their middle [m]; the palm's middle counts
/// as a tip.
double spread(const Hand& hand, const std::vector<int>& used) {
  std::vector<Vector3> tips;
  for (const int finger : used) {
    if (finger == kFingers) tips.push_back(hand.palm.position);
    for (int bone = kBonesPerFinger - 1; finger < kFingers && bone >= 0; --bone) {
      if (!hand.has(capsule_index(finger, bone))) continue;
      tips.push_back(hand.capsules[static_cast<std::size_t>(capsule_index(finger, bone))].end);
      break;
    }
  }
  Vector3 middle = Vector3::Zero();
  for (const Vector3& tip : tips) middle += tip / static_cast<double>(tips.size());
  double sum = 0.0;
  for (const Vector3& tip : tips) sum += (tip - middle).norm() / static_cast<double>(tips.size());
  return sum;
}

std::vector<int> fingers_used(const Stay& stay) {
  std::vector<int> used;
  for (std::size_t i = stay.window(); i <= stay.touched; ++i)
    for (const FingerTouch& touch : touches_of(stay.object.samples[i], stay.hand_id))
      if (std::find(used.begin(), used.end(), touch.finger) == used.end()) used.push_back(touch.finger);
  return used;
}

/// Since when the hand has opened, if it has.
std::optional<double> opened_since(const Stay& stay, const Hands& hand) {
  const std::vector<int> used = fingers_used(stay);
  double least = 1e9, since = 0.0, last = 0.0;
  for (const HandSample& sample : hand) {
    if (sample.time < stay.time(stay.window()) || sample.time > stay.time(stay.last) + 1e-9) continue;
    last = spread(sample.hand, used);
    if (last > least + 1e-5) continue;
    since = sample.time;
    least = std::min(least, last);
  }
  if (last - least < kOpened) return {};
  return since;
}

// What the fingers press, and how.

/// Whether some two of them could hold a body between them at all: each within the other's friction cone.
bool opposed(const std::vector<FingerTouch>& touches, double friction) {
  const double least = -std::cos(2.0 * std::atan(friction));
  for (std::size_t i = 0; i < touches.size(); ++i)
    for (std::size_t j = i + 1; j < touches.size(); ++j)
      if (touches[i].outward.dot(touches[j].outward) <= least) return true;
  return false;
}

bool faces_were_wrong(const Stay& stay) {
  int good = 0, bad = 0;
  for (std::size_t i = stay.window(); i <= stay.touched; ++i) {
    const auto touches = touches_of(stay.object.samples[i], stay.hand_id);
    if (touches.size() < 2) continue;
    ++(opposed(touches, stay.object.material.static_friction) ? good : bad);
  }
  return bad > good;
}

/// First of the samples from which on all fingers slide to the end; the end if they do not.
std::size_t slides_from(const Stay& stay) {
  std::size_t from = stay.touched;
  for (std::size_t i = stay.touched + 1; i-- > stay.window();) {
    const auto touches = touches_of(stay.object.samples[i], stay.hand_id);
    const bool all = std::all_of(touches.begin(), touches.end(), [](const FingerTouch& touch) {
      return touch.slips || touch.share() >= kFull;
    });
    if (!all) break;
    from = i;
  }
  return from;
}

/// Of the palm at a sample, over 40 ms [m/s^2].
Vector3 acceleration(const Hands& hand, double time) {
  constexpr double kSpan = 0.02;
  const HandSample *before = nullptr, *at = nullptr, *after = nullptr;
  for (const HandSample& sample : hand) {
    if (sample.time <= time - kSpan + 1e-6) before = &sample;
    if (at == nullptr && sample.time >= time - 1e-6) at = &sample;
    if (after == nullptr && sample.time >= time + kSpan - 1e-6) after = &sample;
  }
  if (before == nullptr || at == nullptr || after == nullptr) return Vector3::Zero();
  const double a = at->time - before->time, b = after->time - at->time;
  if (a <= 0.0 || b <= 0.0) return Vector3::Zero();
  const Vector3 speed_before = (at->hand.palm.position - before->hand.palm.position) / a;
  const Vector3 speed_after = (after->hand.palm.position - at->hand.palm.position) / b;
  return (speed_after - speed_before) / (0.5 * (a + b));
}

/// The most that the fingers had to bear along the surfaces from a little before they slid: weight, and what
/// it takes to carry the object along.
double load_of(const Stay& stay, const Hands& hand, const Vector3& gravity, std::size_t from) {
  double most = 0.0;
  for (std::size_t i = from; i <= stay.touched; ++i) {
    const auto touches = touches_of(stay.object.samples[i], stay.hand_id);
    if (touches.empty()) continue;
    const auto strongest =
        std::max_element(touches.begin(), touches.end(),
                         [](const FingerTouch& a, const FingerTouch& b) { return a.normal < b.normal; });
    const Vector3 load = stay.object.mass * (acceleration(hand, stay.time(i)) - gravity);
    most = std::max(most, (load - load.dot(strongest->outward) * strongest->outward).norm());
  }
  return most;
}

/// When each finger first slid in the window, in order: "the thumb at 0.62 s (share of the limit 1)".
std::string slides_text(const Stay& stay) {
  std::vector<int> seen;
  std::string text;
  for (std::size_t i = stay.window(); i <= stay.touched; ++i) {
    for (const FingerTouch& touch : touches_of(stay.object.samples[i], stay.hand_id)) {
      if (!touch.slips || std::find(seen.begin(), seen.end(), touch.finger) != seen.end()) continue;
      seen.push_back(touch.finger);
      text += (text.empty() ? "" : ", ") + finger_text(touch.finger) + " slid from " + seconds(stay.time(i));
    }
  }
  return text.empty() ? "no finger slid" : text;
}

std::string faces_text(const Stay& stay) {
  std::string text;
  for (const FingerTouch& touch : touches_of(stay.object.samples[stay.touched], stay.hand_id))
    text += (text.empty() ? "" : ", ") + finger_text(touch.finger) + " on " + touch.face;
  return text;
}

std::string remedy(const Loss& loss) {
  std::string text = "The fingers pushed with " + number(loss.push, " N") + " together, and had to bear " +
                     number(loss.load, " N") + " along the surfaces, of which friction of " +
                     number(loss.friction) + " bears " + number(loss.friction * loss.push, " N") + ". ";
  if (loss.push_needed <= 0.0)
    return text +
           "By these sums it bears it: the object turned, or was pushed out (force and torque together were "
           "borne " +
           number(loss.bearable) + " times over at the least)";
  return text + "Friction of " + number(loss.friction_needed) + " would have held it, or " +
         number(loss.push_needed, " N") + " more push";
}

std::string story_of(const Loss& loss, const Stay& stay, const std::string& why) {
  const std::string what = loss.grasped ? "held from " : "pressed from ";
  return loss.object + " (" + what + seconds(loss.from) + ") was lost at " + seconds(loss.until) + ": " +
         why + ". Before that " + slides_text(stay) + ".";
}

void add_sums(const Stay& stay, const Hands& hand, const Vector3& gravity, Loss& loss) {
  loss.bearable = stay.object.samples[stay.window()].bearable;
  for (std::size_t i = stay.window(); i <= stay.touched; ++i)
    loss.bearable = std::min(loss.bearable, stay.object.samples[i].bearable);
  const std::size_t slid = slides_from(stay);
  const std::size_t from = slid > stay.first + 5 ? slid - 5 : stay.first;
  loss.push = push_of(touches_of(stay.object.samples[slid], stay.hand_id));
  loss.load = load_of(stay, hand, gravity, from);
  loss.friction = stay.object.material.static_friction;
  loss.friction_needed = loss.push > 0.0 ? loss.load / loss.push : 0.0;
  loss.push_needed = std::max(0.0, loss.load / std::max(loss.friction, 1e-3) - loss.push);
}

void find_cause(const Stay& stay, const Hands& hand, const Explanation& story, Loss& loss) {
  const auto tell = [&](LossCause cause, const std::string& why) {
    loss.cause = cause;
    loss.text = story_of(loss, stay, why);
  };
  if (tracking_was_lost(stay, hand))
    return tell(LossCause::tracking_lost, "the tracker lost the hand, and what it held was let go");
  if (const auto blow = worst_blow(stay, story)) {
    loss.by = blow->by;
    return tell(LossCause::blow, "'" + blow->by + "' struck it at " + seconds(blow->time) + ", worth " +
                                     number(blow->speed, " m/s") + ". " + remedy(loss));
  }
  const std::optional<double> opened = opened_since(stay, hand);
  const double slid = stay.time(slides_from(stay));
  if (opened && *opened <= slid + 0.03)
    return tell(LossCause::hand_opened, "the hand opened, from " + seconds(*opened) + " on");
  if (faces_were_wrong(stay))
    return tell(LossCause::wrong_faces, "no two fingers pressed against each other within friction (" +
                                            faces_text(stay) + "), so that no force could have held it");
  if (loss.push_needed <= 0.0) return tell(LossCause::not_known, remedy(loss));
  const bool slippery = loss.friction < kSlippery;
  tell(slippery ? LossCause::too_little_friction : LossCause::too_little_force,
       std::string(slippery ? "it is too slippery for that push" : "it was held too weakly") + ". " +
           remedy(loss));
}

/// Highest level that the object had from one sample to another.
bool was_grasped(const Samples& samples, std::size_t from, std::size_t to) {
  return std::any_of(samples.begin() + static_cast<std::ptrdiff_t>(from),
                     samples.begin() + static_cast<std::ptrdiff_t>(to) + 1,
                     [](const ObjectSample& sample) { return sample.level == InteractionLevel::grasp; });
}

bool together(const ObjectSample& sample) {
  return sample.level == InteractionLevel::grasp || !sample.fingers.empty();
}

/// Two fingers at least, for long enough.
bool is_attempt(const Samples& samples, std::size_t from, std::size_t to) {
  const bool long_enough = samples[to].time - samples[from].time >= kAttempt;
  return long_enough && std::any_of(samples.begin() + static_cast<std::ptrdiff_t>(from),
                                    samples.begin() + static_cast<std::ptrdiff_t>(to) + 1,
                                    [](const ObjectSample& sample) { return sample.fingers.size() >= 2; });
}

void end_stay(const std::string& name, const ObjectStory& object, std::size_t first, std::size_t last,
              const Explanation& story, std::vector<Loss>& losses) {
  const Samples& samples = object.samples;
  std::size_t touched = last;
  while (touched > first && samples[touched].fingers.empty()) --touched;
  const bool grasped = was_grasped(samples, first, last);
  if (samples[touched].fingers.empty() || (!grasped && !is_attempt(samples, first, touched))) return;
  const std::uint32_t hand_id = samples[touched].fingers.front().hand_id;
  const Stay stay{name, object, hand_id, grasped, first, touched, last};
  Loss loss;
  loss.object = name;
  loss.hand_id = hand_id;
  loss.grasped = grasped;
  loss.from = samples[first].time;
  loss.until = samples[touched].time;
  const Hands& hand = story.hands.at(hand_id);
  add_sums(stay, hand, story.gravity, loss);
  find_cause(stay, hand, story, loss);
  losses.push_back(loss);
}

}  // namespace

const char* to_string(LossCause cause) {
  constexpr const char* kNames[] = {
      "tracking_lost",    "blow",     "hand_opened", "wrong_faces", "too_little_friction",
      "too_little_force", "not_known"};
  return kNames[static_cast<std::size_t>(cause)];
}

std::vector<Loss> find_losses(const Explanation& story) {
  constexpr double kBreak = 0.06;  // touches that are apart by less are one stay [s]
  std::vector<Loss> losses;
  for (const auto& [name, object] : story.objects) {
    std::optional<std::size_t> first;
    std::size_t last = 0;
    for (std::size_t i = 0; i < object.samples.size(); ++i) {
      if (together(object.samples[i])) {
        if (!first) first = i;
        last = i;
      } else if (first && object.samples[i].time - object.samples[last].time > kBreak) {
        end_stay(name, object, *first, i - 1, story, losses);
        first.reset();
      }
    }
  }
  std::stable_sort(losses.begin(), losses.end(),
                   [](const Loss& a, const Loss& b) { return a.until < b.until; });
  return losses;
}

}  // namespace mrhi
