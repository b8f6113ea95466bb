#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "explain.h"

namespace mrhi {
namespace {

constexpr double kWindow = 0.6;        // before an object is let go, in which its cause is sought [s]
constexpr double kAttempt = 0.1;       // shorter touches are no attempts to grasp [s]
constexpr double kTracking = 0.5;      // a hand may be kept that long after it was seen last [s]
constexpr double kBlow = 0.05;         // change of the object's speed by another that counts [m/s]
constexpr double kBlowWindow = 0.4;    // [s]
constexpr double kOpened = 0.003;      // of the mean distance of the fingertips from their middle [m]
constexpr double kBegan = 0.001;       // of that, as the fingers still touch [m]
constexpr double kSliding = 0.02;      // what all fingers do for a shorter time is their leaving [s]
constexpr double kSlippery = 0.4;      // static friction below that of skin (docs/contact.md)
constexpr double kMostFriction = 2.0;  // that is worth naming
constexpr double kUsual = 0.8;         // static friction of skin; what it would not have borne lacked push
constexpr double kHelped = 0.15;       // help that bore until so long before the end gave way [s]
constexpr double kLeft = 0.02;         // change of speed by a touch that is told [m/s]

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

struct Opening {
  double begun = 0.0;  ///< when the hand was closed most [s]
  double clear = 0.0;  ///< since when it is open by a tenth of `by`, and more [s]
  double by = 0.0;     ///< in the first frame without touch [m]
};

using Spreads = std::vector<std::pair<double, double>>;  // time, size

Spreads spreads_of(const Stay& stay, const Hands& hand) {
  const std::vector<int> used = fingers_used(stay);
  Spreads spreads;
  for (const HandSample& sample : hand)
    if (sample.time >= stay.time(stay.window()) - 1e-9 && sample.time <= stay.time(stay.last) + 1e-9)
      spreads.emplace_back(sample.time, spread(sample.hand, used));
  return spreads;
}

/// Of a hand that had begun to open as it touched last, and went on.
std::optional<Opening> opening_of(const Stay& stay, const Hands& hand) {
  constexpr double kClear = 0.1;
  const Spreads spreads = spreads_of(stay, hand);
  const double until = stay.time(std::min(stay.touched + 1, stay.object.samples.size() - 1)) + 1e-9;
  const auto end = std::find_if(spreads.begin(), spreads.end(),
                                [until](const auto& sample) { return sample.first > until; });
  if (end == spreads.begin()) return {};
  auto least = spreads.begin();
  for (auto at = spreads.begin(); at != end; ++at)
    if (at->second <= least->second + 1e-5) least = at;
  Opening opening{least->first, least->first, std::prev(end)->second - least->second};
  for (auto at = least; at != end; ++at)
    if (at->second <= least->second + kClear * opening.by) opening.clear = at->first;
  if (opening.by < kBegan || spreads.back().second - least->second < kOpened) return {};
  return opening;
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

bool all_slide(const std::vector<FingerTouch>& touches) {
  // No share tells it: help, and edges, bear more than the limit.
  return std::all_of(touches.begin(), touches.end(), [](const FingerTouch& touch) { return touch.slips; });
}

/// First of the samples from which on all fingers slide to the end, a catch of some frames left out; the end
/// if they do not.
std::size_t slides_from(const Stay& stay) {
  constexpr double kCatch = 0.03;  // [s]
  std::size_t from = stay.touched;
  for (std::size_t i = stay.touched + 1; i-- > stay.window();) {
    if (all_slide(touches_of(stay.object.samples[i], stay.hand_id))) from = i;
    if (stay.time(from) - stay.time(i) > kCatch) break;
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

/// The most that fingers bore along the surfaces: what hangs on a joint is not carried.
double borne_in(const Stay& stay, std::size_t from) {
  double most = 0.0;
  for (std::size_t i = from; i <= stay.touched; ++i) {
    double sum = 0.0;
    for (const FingerTouch& touch : touches_of(stay.object.samples[i], stay.hand_id)) sum += touch.tangential;
    most = std::max(most, sum);
  }
  return most;
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

/// When fingers touched last, in order, those in the last 0.6 s: " The ring left at 0.15 s, last the thumb."
std::string leaves_text(const Stay& stay) {
  std::vector<std::pair<double, int>> left;
  for (std::size_t i = stay.touched + 1; i-- > stay.window();)
    for (const FingerTouch& touch : touches_of(stay.object.samples[i], stay.hand_id)) {
      const auto known =
          std::find_if(left.begin(), left.end(), [&](const auto& one) { return one.second == touch.finger; });
      if (known == left.end()) left.emplace_back(stay.time(i), touch.finger);
    }
  std::sort(left.begin(), left.end());
  std::string text;
  for (const auto& [time, finger] : left)
    text += (text.empty() ? " " : ", then ") + finger_text(finger) + " at " + seconds(time);
  return " Last touches:" + text + ".";
}

/// Of the frame, among the last ones, in which most fingers touched.
std::string faces_text(const Stay& stay) {
  std::vector<FingerTouch> most;
  for (std::size_t i = stay.window(); i <= stay.touched; ++i) {
    const auto touches = touches_of(stay.object.samples[i], stay.hand_id);
    if (touches.size() >= most.size()) most = touches;
  }
  std::string text;
  for (const FingerTouch& touch : most)
    text += (text.empty() ? "" : ", ") + finger_text(touch.finger) + " on " + touch.face;
  return text;
}

/// From when to when help bore the object in this stay, if it did.
std::optional<std::pair<double, double>> helped_in(const Stay& stay) {
  std::optional<std::pair<double, double>> helped;
  for (std::size_t i = stay.first; i <= stay.touched; ++i) {
    if (!stay.object.samples[i].helped) continue;
    if (!helped) helped = {stay.time(i), stay.time(i)};
    helped->second = stay.time(i);
  }
  return helped;
}

std::string help_text(const Stay& stay) {
  const auto helped = helped_in(stay);
  if (!helped) return "";
  return " Help for bare hands (contact/grasp_assist) bore it from " + seconds(helped->first) + " to " +
         seconds(helped->second) + ", beyond what friction bears.";
}

std::string remedy(const Loss& loss) {
  std::string text = "The fingers pushed with " + number(loss.push, " N") + " together, and had to bear " +
                     number(loss.load, " N") + " along the surfaces, of which friction of " +
                     number(loss.friction) + " bears " + number(loss.friction * loss.push, " N") + ". ";
  if (loss.push_needed <= 0.0)
    return text +
           "By these sums friction bears a straight pull: it turned, or was pushed out (of force and torque "
           "together friction bore " +
           number(loss.bearable) + " times the load at the least)";
  const std::string more = number(loss.push_needed, " N") + " more push";
  if (loss.friction_needed > kMostFriction) return text + "Against that it takes " + more;
  return text + "Against that it takes friction of " + number(loss.friction_needed) + ", or " + more;
}

std::string story_of(const Loss& loss, const Stay& stay, const std::string& why) {
  const std::string what = loss.grasped ? "held from " : "pressed from ";
  const bool opened = loss.cause == LossCause::hand_opened;
  return loss.object + " (" + what + seconds(loss.from) + ") was " + (opened ? "let go" : "lost") + " at " +
         seconds(loss.until) + ": " + why + ". Before that " + slides_text(stay) + "." + leaves_text(stay) +
         help_text(stay);
}

void add_sums(const Stay& stay, const Hands& hand, const Vector3& gravity, Loss& loss) {
  loss.bearable = stay.object.samples[stay.window()].bearable;
  for (std::size_t i = stay.window(); i <= stay.touched; ++i)
    loss.bearable = std::min(loss.bearable, stay.object.samples[i].bearable);
  const std::size_t slid = slides_from(stay);
  const std::size_t from = slid > stay.first + 5 ? slid - 5 : stay.first;
  loss.push = push_of(touches_of(stay.object.samples[slid], stay.hand_id));
  loss.load = stay.object.joint.empty() ? load_of(stay, hand, gravity, from) : borne_in(stay, stay.window());
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
  const std::optional<Opening> opening = opening_of(stay, hand);
  const double slid = stay.time(slides_from(stay));
  if (opening && opening->begun <= slid + 0.03) {
    loss.opened = opening->clear;
    return tell(LossCause::hand_opened, "the hand opened, by " + number(1e3 * opening->by, " mm") +
                                            " at its fingertips from " + seconds(opening->clear) + " on");
  }
  const auto helped = helped_in(stay);
  if (helped && helped->second > stay.time(stay.touched) - kHelped)
    return tell(LossCause::help_gave_way,
                "contact alone did not hold it, and the help that bore it gave way");
  if (!stay.object.joint.empty())
    return tell(slid < stay.time(stay.touched) ? LossCause::too_little_force : LossCause::not_known,
                "it hangs on joint '" + stay.object.joint + "', of which the fingers bore " +
                    number(loss.load, " N") + " along the surfaces with a push of " +
                    number(loss.push, " N"));
  if (faces_were_wrong(stay))
    return tell(LossCause::wrong_faces, "no two fingers pressed against each other within friction (" +
                                            faces_text(stay) + "), so that no force could have held it");
  const bool all_slid = stay.time(stay.touched) - slid >= kSliding;
  const bool slippery = loss.friction < kSlippery && kUsual * loss.push >= loss.load;
  const LossCause weak = slippery ? LossCause::too_little_friction : LossCause::too_little_force;
  const double sliding = stay.object.material.dynamic_friction * loss.push;
  if (all_slid && loss.push_needed <= 0.0 && sliding < loss.load)
    return tell(weak, "all fingers slid, from " + seconds(slid) + " on: friction then bore " +
                          number(sliding, " N") + ", and " + number(loss.friction * loss.push, " N") +
                          " while it stuck, of the " + number(loss.load, " N") +
                          " that a straight pull took, and of what turned it besides");
  if (loss.push_needed <= 0.0) return tell(LossCause::not_known, remedy(loss));
  if (!all_slid || loss.push <= 0.0)
    return tell(LossCause::not_known,
                "it did not slide along its fingers, which did not open either: it turned, or was pushed out "
                "between them");
  tell(weak, std::string(slippery ? "it is too slippery for that push" : "it was held too weakly") + ". " +
                 remedy(loss));
}

/// Highest level that the object had from one sample to another.
bool was_grasped(const Samples& samples, std::size_t from, std::size_t to) {
  return std::any_of(samples.begin() + static_cast<std::ptrdiff_t>(from),
                     samples.begin() + static_cast<std::ptrdiff_t>(to) + 1,
                     [](const ObjectSample& sample) { return sample.level == InteractionLevel::grasp; });
}

bool together(const ObjectSample& sample) {
  return sample.level == InteractionLevel::grasp || !sample.fingers.empty() || !sample.struck.empty();
}

/// Two fingers at least, for long enough.
bool is_attempt(const Samples& samples, std::size_t from, std::size_t to) {
  const bool long_enough = samples[to].time - samples[from].time >= kAttempt;
  return long_enough && std::any_of(samples.begin() + static_cast<std::ptrdiff_t>(from),
                                    samples.begin() + static_cast<std::ptrdiff_t>(to) + 1,
                                    [](const ObjectSample& sample) { return sample.fingers.size() >= 2; });
}

void add_touch(const Stay& stay, std::vector<Touch>& touches) {
  const Samples& samples = stay.object.samples;
  const Vector3 before = samples[stay.first == 0 ? 0 : stay.first - 1].velocity;
  const double gained = samples[stay.last].velocity.norm() - before.norm();
  if (gained < kLeft) return;
  Touch touch{stay.name, stay.hand_id, stay.time(stay.first), stay.time(stay.touched), {}, gained};
  const auto add = [&](int finger) {
    if (std::find(touch.fingers.begin(), touch.fingers.end(), finger) == touch.fingers.end())
      touch.fingers.push_back(finger);
  };
  for (std::size_t i = stay.first; i <= stay.touched; ++i) {
    for (const FingerTouch& finger : samples[i].fingers) add(finger.finger);
    for (const int finger : samples[i].struck) add(finger);
  }
  touches.push_back(touch);
}

void end_stay(const std::string& name, const ObjectStory& object, std::size_t first, std::size_t last,
              Explanation& story) {
  const Samples& samples = object.samples;
  std::size_t touched = last;
  while (touched > first && samples[touched].fingers.empty() && samples[touched].struck.empty()) --touched;
  const bool struck = samples[touched].fingers.empty();  // and not touched when it was last seen with a hand
  if (struck && samples[touched].struck.empty()) return;
  const bool grasped = was_grasped(samples, first, last);
  const std::uint32_t hand_id =
      struck ? samples[touched].struck_by : samples[touched].fingers.front().hand_id;
  const Stay stay{name, object, hand_id, grasped, first, touched, last};
  if (!grasped && !is_attempt(samples, first, touched)) return add_touch(stay, story.touches);
  Loss loss;
  loss.object = name;
  loss.hand_id = hand_id;
  loss.grasped = grasped;
  loss.from = samples[first].time;
  loss.until = samples[touched].time;
  const Hands& hand = story.hands.at(hand_id);
  add_sums(stay, hand, story.gravity, loss);
  find_cause(stay, hand, story, loss);
  story.losses.push_back(loss);
}

template <class Told>
void sort_by_end(std::vector<Told>& told) {
  std::stable_sort(told.begin(), told.end(), [](const Told& a, const Told& b) { return a.until < b.until; });
}

}  // namespace

std::string finger_text(int finger) {
  return finger == kFingers ? "the palm" : std::string("the ") + finger_name(capsule_index(finger, 3));
}

const char* to_string(LossCause cause) {
  constexpr const char* kNames[] = {"tracking_lost",    "blow",        "hand_opened",
                                    "help_gave_way",    "wrong_faces", "too_little_friction",
                                    "too_little_force", "not_known"};
  return kNames[static_cast<std::size_t>(cause)];
}

void find_losses(Explanation& story) {
  constexpr double kBreak = 0.06;  // touches that are apart by less are one stay [s]
  for (const auto& [name, object] : story.objects) {
    std::optional<std::size_t> first;
    std::size_t last = 0;
    for (std::size_t i = 0; i < object.samples.size(); ++i) {
      if (together(object.samples[i])) {
        if (!first) first = i;
        last = i;
      } else if (first && object.samples[i].time - object.samples[last].time > kBreak) {
        end_stay(name, object, *first, i - 1, story);
        first.reset();
      }
    }
  }
  sort_by_end(story.losses);
  sort_by_end(story.touches);
}

}  // namespace mrhi
