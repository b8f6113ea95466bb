
#include <algorithm>
#include <cstdio>

#include "explain_chart.h"

namespace mrhi {
namespace {

constexpr double kPicture = 224.0;  // [px]
constexpr double kBefore = 0.15;    // a loss [s]

std::string fixed(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.1f", value);
  return text;
}

/// Seen along one of the world's axes: capsules as thick lines, a box by its edges.
class Picture {
 public:
  Picture(const Vector3& middle, double extent, int right, int up)
      : middle_(middle), scale_(kPicture / extent), right_(right), up_(up) {}

  std::string point(const Vector3& place) const {
    const Vector3 from_middle = scale_ * (place - middle_);
    return fixed(0.5 * kPicture + from_middle[right_]) + "," + fixed(0.5 * kPicture - from_middle[up_]);
  }
  std::string line(const Vector3& a, const Vector3& b, double width, const std::string& color,
                   double opacity = 1.0) const {
    return "<polyline points='" + point(a) + " " + point(b) + "' stroke='" + color + "' stroke-opacity='" +
           short_number(opacity) + "' stroke-linecap='round' fill='none' stroke-width='" +
           fixed(std::max(1.0, scale_ * width)) + "'/>";
  }
  std::string ball(const Vector3& place, double radius) const {
    const std::string at = point(place);
    const std::size_t comma = at.find(',');
    return "<circle cx='" + at.substr(0, comma) + "' cy='" + at.substr(comma + 1) + "' r='" +
           fixed(scale_ * radius) + "' fill='none' stroke='#000'/>";
  }

 private:
  Vector3 middle_;
  double scale_;
  int right_, up_;
};

std::string hand_drawn(const Picture& picture, const Hand& hand, const ObjectSample& object) {
  std::string lines;
  for (int i = 0; i < kCapsules; ++i) {
    if (!hand.has(i)) continue;
    const Capsule& capsule = hand.capsules[static_cast<std::size_t>(i)];
    const bool touches = std::any_of(
        object.fingers.begin(), object.fingers.end(),
        [&](const FingerTouch& touch) { return touch.finger == finger_of(i) && touch.hand_id == hand.id; });
    lines += picture.line(capsule.start, capsule.end, 2.0 * capsule.radius, finger_color(finger_of(i)),
                          touches ? 0.8 : 0.35);
  }
  return lines;
}

std::string object_drawn(const Picture& picture, const ObjectStory& story, const ObjectSample& at) {
  if (story.half.isZero(0.0)) return picture.ball(at.position, story.radius);
  std::string lines;
  const auto corner = [&](int i) -> Vector3 {
    const Vector3 signs((i & 1) ? 1 : -1, (i & 2) ? 1 : -1, (i & 4) ? 1 : -1);
    return at.position + at.orientation * story.half.cwiseProduct(signs);
  };
  for (int i = 0; i < 8; ++i)
    for (const int bit : {1, 2, 4})
      if ((i & bit) == 0) lines += picture.line(corner(i), corner(i | bit), 0.0, "#000");
  return lines;
}

const HandSample* hand_at(const std::vector<HandSample>& samples, double time) {
  const auto found = std::find_if(samples.begin(), samples.end(),
                                  [&](const HandSample& sample) { return sample.time >= time - 1e-6; });
  return found == samples.end() ? (samples.empty() ? nullptr : &samples.back()) : &*found;
}

std::string pictures_at(const Explanation& story, const Loss& loss, double time) {
  const ObjectStory& object = story.objects.at(loss.object);
  const auto at = std::find_if(object.samples.begin(), object.samples.end(),
                               [&](const ObjectSample& sample) { return sample.time >= time - 1e-6; });
  if (at == object.samples.end()) return "";
  const HandSample* hand = hand_at(story.hands.at(loss.hand_id), time);
  std::string all;
  for (const int right : {0, 1}) {
    const Picture picture(at->position, 0.12 + 4.0 * object.radius, right, 2);
    all += svg(kPicture, kPicture,
               (hand != nullptr ? hand_drawn(picture, hand->hand, *at) : "") +
                   object_drawn(picture, object, *at) +
                   text_at(4, 14,
                           short_number(at->time) + " s, seen along " + (right == 0 ? "y" : "x") +
                               (object.half.isZero(0.0) ? "; circle: all of it" : "")),
               "drawing");
  }
  return all;
}

}  // namespace

const char* finger_color(int finger) {
  constexpr const char* kColors[] = {"#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00", "#555555"};
  return kColors[std::min(finger, kFingers)];
}

std::string drawings_of(const Explanation& story, const Loss& loss) {
  return pictures_at(story, loss, std::max(loss.from, loss.until - kBefore)) +
         pictures_at(story, loss, loss.until);
}

}  // namespace mrhi
