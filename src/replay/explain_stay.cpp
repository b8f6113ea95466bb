#include "explain_stay.h"

#include <algorithm>
#include <cmath>

namespace mrhi {
namespace {

constexpr double kWindow = 0.6;      // before an object is let go, in which its cause is sought [s]
constexpr double kTracking = 0.5;    // a hand may be kept that long after it was seen last [s]
constexpr double kBlow = 0.05;       // change of the object's speed by another that counts [m/s]
constexpr double kBlowWindow = 0.4;  // [s]
constexpr double kOpened = 0.003;    // of the mean distance of the fingertips from their middle [m]
constexpr double kBegan = 0.001;     // of that, as the fingers still touch [m]

using Samples = std::vector<ObjectSample>;
using Hands = std::vector<HandSample>;

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

using Spreads = std::vector<std::pair<double, double>>;  // time, size

Spreads spreads_of(const Stay& stay, const Hands& hand) {
  const std::vector<int> used = fingers_used(stay);
  Spreads spreads;
  for (const HandSample& sample : hand)
    if (sample.time >= stay.time(stay.window()) - 1e-9 && sample.time <= stay.time(stay.last) + 1e-9)
      spreads.emplace_back(sample.time, spread(sample.hand, used));
  return spreads;
}

/// Whether some two of them could hold a body between them at all: each within the other's friction cone.
bool opposed(const std::vector<FingerTouch>& touches, double friction) {
  const double least = -std::cos(2.0 * std::atan(friction));
  for (std::size_t i = 0; i < touches.size(); ++i)
    for (std::size_t j = i + 1; j < touches.size(); ++j)
      if (touches[i].outward.dot(touches[j].outward) <= least) return true;
  return false;
}

bool all_slide(const std::vector<FingerTouch>& touches) {
  // No share tells it: help, and edges, bear more than the limit.
  return std::all_of(touches.begin(), touches.end(), [](const FingerTouch& touch) { return touch.slips; });
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

}  // namespace

std::size_t Stay::window() const {
  std::size_t i = touched;
  while (i > first && time(touched) - time(i - 1) <= kWindow) --i;
  return i;
}

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

bool tracking_was_lost(const Stay& stay, const Hands& hand) {
  const double from = stay.time(stay.touched) - kTracking, until = stay.time(stay.last);
  const bool held = std::any_of(hand.begin(), hand.end(), [&](const HandSample& sample) {
    return sample.lost && sample.time >= from && sample.time <= until + 1e-9;
  });
  return held || hand.back().time < until - 1e-9;
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

bool faces_were_wrong(const Stay& stay) {
  int good = 0, bad = 0;
  for (std::size_t i = stay.window(); i <= stay.touched; ++i) {
    const auto touches = touches_of(stay.object.samples[i], stay.hand_id);
    if (touches.size() < 2) continue;
    ++(opposed(touches, stay.object.material.static_friction) ? good : bad);
  }
  return bad > good;
}

std::size_t slides_from(const Stay& stay) {
  constexpr double kCatch = 0.03;  // [s]
  std::size_t from = stay.touched;
  for (std::size_t i = stay.touched + 1; i-- > stay.window();) {
    if (all_slide(touches_of(stay.object.samples[i], stay.hand_id))) from = i;
    if (stay.time(from) - stay.time(i) > kCatch) break;
  }
  return from;
}

double borne_in(const Stay& stay, std::size_t from) {
  double most = 0.0;
  for (std::size_t i = from; i <= stay.touched; ++i) {
    double sum = 0.0;
    for (const FingerTouch& touch : touches_of(stay.object.samples[i], stay.hand_id)) sum += touch.tangential;
    most = std::max(most, sum);
  }
  return most;
}

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

std::optional<std::pair<double, double>> helped_in(const Stay& stay) {
  std::optional<std::pair<double, double>> helped;
  for (std::size_t i = stay.first; i <= stay.touched; ++i) {
    if (!stay.object.samples[i].helped) continue;
    if (!helped) helped = {stay.time(i), stay.time(i)};
    helped->second = stay.time(i);
  }
  return helped;
}

}  // namespace mrhi
