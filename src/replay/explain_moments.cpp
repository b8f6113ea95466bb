#include <algorithm>

#include "explain.h"

namespace mrhi {
namespace {

constexpr double kBefore = 0.15;  // a loss [s]

const ObjectSample* sample_at(const ObjectStory& object, double time) {
  const auto found = std::find_if(object.samples.begin(), object.samples.end(),
                                  [&](const ObjectSample& sample) { return sample.time >= time - 1e-6; });
  return found == object.samples.end() ? nullptr : &*found;
}

/// Between the thumb or palm and the other fingers, by the sides that they press.
Vector3 across_grip(const ObjectSample& sample) {
  Vector3 across = Vector3::Zero();
  for (const FingerTouch& touch : sample.fingers)
    across += (touch.finger == 0 || touch.finger == kFingers ? -1.0 : 1.0) * touch.outward;
  return across.norm() > 0.1 ? Vector3(across.normalized()) : Vector3(Vector3::Zero());
}

void add(PictureMoment::What what, const std::string& name, std::uint32_t hand_id, double time,
         std::optional<std::size_t> loss, const Explanation& story, std::vector<PictureMoment>& moments) {
  const auto object = story.objects.find(name);
  if (object == story.objects.end()) return;
  const ObjectSample* sample = sample_at(object->second, time);
  if (sample == nullptr) return;
  PictureMoment moment;
  moment.what = what;
  moment.object = name;
  moment.time = sample->time;
  moment.loss = loss;
  moment.place = moment.palm = sample->position;
  const auto hand = story.hands.find(sample->fingers.empty() ? hand_id : sample->fingers.front().hand_id);
  if (hand != story.hands.end()) {
    for (const HandSample& seen : hand->second)
      if (seen.time <= sample->time + 1e-6) moment.palm = seen.hand.palm.position;
  }
  moment.across = across_grip(*sample);
  moment.radius = object->second.radius;
  moments.push_back(moment);
}

}  // namespace

const char* to_string(PictureMoment::What what) {
  constexpr const char* kNames[] = {"grasp", "before_loss", "loss"};
  return kNames[static_cast<std::size_t>(what)];
}

std::vector<PictureMoment> picture_moments(const Explanation& story) {
  using What = PictureMoment::What;
  std::vector<PictureMoment> moments;
  for (const ToldEvent& event : story.events)
    if (event.kind == EventKind::grasp_begin)
      add(What::grasp, event.object, event.hand_id, event.time, {}, story, moments);
  for (std::size_t i = 0; i < story.losses.size(); ++i) {
    const Loss& loss = story.losses[i];
    add(What::before_loss, loss.object, loss.hand_id, std::max(loss.from, loss.until - kBefore), i, story,
        moments);
    add(What::loss, loss.object, loss.hand_id, loss.until, i, story, moments);
  }
  std::stable_sort(moments.begin(), moments.end(),
                   [](const PictureMoment& a, const PictureMoment& b) { return a.time < b.time; });
  for (PictureMoment& moment : moments) {  // a grasp belongs to the loss that ends it
    const auto ends = std::find_if(story.losses.begin(), story.losses.end(), [&](const Loss& loss) {
      return loss.object == moment.object && loss.from <= moment.time && moment.time <= loss.until;
    });
    if (ends != story.losses.end()) moment.loss = static_cast<std::size_t>(ends - story.losses.begin());
  }
  return moments;
}

}  // namespace mrhi
