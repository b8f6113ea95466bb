#include <algorithm>
#include <cstdio>
#include <optional>

#include "explain_stay.h"

namespace mrhi {
namespace {

constexpr double kAttempt = 0.1;       // shorter touches are no attempts to grasp [s]
constexpr double kSliding = 0.02;      // what all fingers do for a shorter time is their leaving [s]
constexpr double kSlippery = 0.4;      // static friction below that of skin (docs/contact.md)
constexpr double kMostFriction = 2.0;  // that is worth naming
constexpr double kUsual = 0.8;         // static friction of skin; what it would not have borne lacked push
constexpr double kHelped = 0.15;       // help that bore until so long before the end gave way [s]
constexpr double kLeft = 0.02;         // change of speed by a touch that is told [m/s]

using Samples = std::vector<ObjectSample>;
using Hands = std::vector<HandSample>;

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

/// When each finger first slid in the window, in order: "the thumb slid from 0.62 s".
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

/// When each finger that did in the window touched last, in order: " Last touches: the ring at 0.15 s."
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
