#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

#include "explain.h"

namespace mrhi {
namespace {

constexpr double kWidth = 900.0, kHeight = 120.0, kLeft = 60.0, kPicture = 260.0;
const char* const kColors[] = {"#d62728", "#1f77b4", "#2ca02c",
                               "#9467bd", "#ff7f0e", "#7f7f7f"};  // thumb to palm

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '<') result += "&lt;";
    if (c == '>') result += "&gt;";
    if (c == '&') result += "&amp;";
    if (c != '<' && c != '>' && c != '&') result += c;
  }
  return result;
}

std::string fixed(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.1f", std::isfinite(value) ? value : 0.0);
  return text;
}

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

/// Charts of one object have one axis of time.
struct TimeAxis {
  double from, until;

  double x(double time) const {
    return kLeft + (kWidth - kLeft) * (time - from) / std::max(until - from, 1e-9);
  }
};

std::string text_at(double x, double y, const std::string& text, const char* anchor = "start") {
  return "<text x='" + fixed(x) + "' y='" + fixed(y) + "' text-anchor='" + anchor + "'>" + escaped(text) +
         "</text>";
}

std::string svg(double height, const std::string& inside) {
  return "<svg viewBox='0 0 " + fixed(kWidth) + " " + fixed(height) + "' width='" + fixed(kWidth) + "'>" +
         inside + "</svg>\n";
}

const char* color_of(Course course) {
  constexpr const char* kCourses[] = {"#eeeeee", "#f2d492", "#8fc98f", "#e8804d", "#c0c8e0"};
  return kCourses[static_cast<std::size_t>(course)];
}

std::string line_of_time(const ObjectStory& story, const TimeAxis& axis) {
  std::string bars;
  const auto& samples = story.samples;
  for (std::size_t i = 0; i < samples.size();) {
    std::size_t end = i;
    while (end < samples.size() && samples[end].course == samples[i].course) ++end;
    const double x = axis.x(samples[i].time), until = axis.x(samples[std::min(end, samples.size() - 1)].time);
    bars += "<rect x='" + fixed(x) + "' y='2' width='" + fixed(std::max(until - x, 0.5)) +
            "' height='20' fill='" + color_of(samples[i].course) + "'><title>" +
            to_string(samples[i].course) + " from " + number(samples[i].time) + " s</title></rect>";
    i = end;
  }
  std::string legend;
  double x = kLeft;
  for (const Course course : {Course::free, Course::contact, Course::hold, Course::slip, Course::drop}) {
    legend += "<rect x='" + fixed(x) + "' y='30' width='12' height='12' fill='" + color_of(course) + "'/>" +
              text_at(x + 16, 40, to_string(course));
    x += 90;
  }
  return svg(46, bars + legend);
}

struct Curve {
  std::string color;
  std::vector<std::pair<double, double>> points;
};

std::string polyline(const Curve& curve, const TimeAxis& axis, double most) {
  constexpr double kBreak = 0.1;  // [s]
  std::string lines, points;
  double before = -1e9;
  const auto end_line = [&] {
    if (!points.empty())
      lines += "<polyline fill='none' stroke='" + curve.color + "' points='" + points + "'/>";
    points.clear();
  };
  for (const auto& [time, value] : curve.points) {
    if (time - before > kBreak) end_line();
    before = time;
    const double y = kHeight - 16 - (kHeight - 24) * std::clamp(value / most, 0.0, 1.0);
    points += fixed(axis.x(time)) + "," + fixed(y) + " ";
  }
  end_line();
  return lines;
}

std::string chart(const std::string& title, const std::vector<Curve>& curves, const TimeAxis& axis,
                  double least_top) {
  double most = least_top;
  for (const Curve& curve : curves)
    for (const auto& point : curve.points) most = std::max(most, point.second);
  std::string inside =
      text_at(0, 14, number(most)) + text_at(0, kHeight - 16, "0") + text_at(kLeft, 10, title);
  inside += "<line x1='" + fixed(kLeft) + "' x2='" + fixed(kWidth) + "' y1='" + fixed(kHeight - 16) +
            "' y2='" + fixed(kHeight - 16) + "' stroke='#999'/>";
  for (int i = 0; i <= 6; ++i) {
    const double time = axis.from + (axis.until - axis.from) * i / 6;
    inside += text_at(axis.x(time), kHeight - 2, number(time) + " s",
                      i == 0   ? "start"
                      : i == 6 ? "end"
                               : "middle");
  }
  for (const Curve& curve : curves) inside += polyline(curve, axis, most);
  return svg(kHeight, inside);
}

std::vector<Curve> of_fingers(const ObjectStory& story,
                              const std::function<double(const FingerTouch&)>& value) {
  std::vector<Curve> curves;
  for (const char* color : kColors) curves.push_back({color, {}});
  for (const ObjectSample& sample : story.samples)
    for (const FingerTouch& touch : sample.fingers)
      curves[static_cast<std::size_t>(touch.finger)].points.emplace_back(sample.time, value(touch));
  return curves;
}

constexpr double kMostShown = 5.0;  // times the load

std::vector<Curve> of_grip(const ObjectStory& story, double ObjectSample::*member, double most = 1e9) {
  Curve curve{"#333333", {}};
  for (const ObjectSample& sample : story.samples)
    if (!sample.fingers.empty())
      curve.points.emplace_back(sample.time, std::min(most, std::abs(sample.*member)));
  return {curve};
}

std::vector<Curve> speeds(const Explanation& story) {
  std::vector<Curve> curves;
  for (const auto& [id, samples] : story.hands) {
    Curve seen{"#333333", {}}, lost{"#e8804d", {}};
    for (const HandSample& sample : samples)
      (sample.lost ? lost : seen).points.emplace_back(sample.time, sample.speed);
    curves.push_back(seen);
    curves.push_back(lost);
  }
  return curves;
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
           number(opacity) + "' stroke-linecap='round' fill='none' stroke-width='" +
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
    lines += picture.line(capsule.start, capsule.end, 2.0 * capsule.radius,
                          kColors[std::min(finger_of(i), kFingers)], touches ? 0.8 : 0.35);
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
    all += "<svg viewBox='0 0 260 260' width='260' class='picture'>" +
           (hand != nullptr ? hand_drawn(picture, hand->hand, *at) : "") +
           object_drawn(picture, object, *at) +
           text_at(4, 14, number(at->time) + " s, seen along " + (right == 0 ? "y" : "x")) + "</svg>";
  }
  return all;
}

std::string loss_section(const Explanation& story, const Loss& loss) {
  std::string all = "<section><h3>" + escaped(loss.object) + ": " +
                    escaped(std::string(to_string(loss.cause))) + "</h3><p>" + escaped(loss.text) + "</p>";
  all +=
      pictures_at(story, loss, std::max(loss.from, loss.until - 0.15)) + pictures_at(story, loss, loss.until);
  return all + "</section>\n";
}

std::string object_section(const Explanation& story, const std::string& name, const ObjectStory& object) {
  if (object.samples.empty()) return "";
  const TimeAxis axis{object.samples.front().time, object.samples.back().time};
  std::string all = "<h2>" + escaped(name) + "</h2>\n" + line_of_time(object, axis);
  const bool touched = std::any_of(object.samples.begin(), object.samples.end(),
                                   [](const ObjectSample& sample) { return !sample.fingers.empty(); });
  if (!touched) return all + "<p>No hand touches it.</p>\n";
  all += chart("push of each finger [N]", of_fingers(object, [](const FingerTouch& t) { return t.normal; }),
               axis, 0.1);
  all += chart("share of the friction limit",
               of_fingers(object, [](const FingerTouch& t) { return t.share(); }), axis, 1.0);
  all +=
      chart("depth [mm]", of_fingers(object, [](const FingerTouch& t) { return 1e3 * t.depth; }), axis, 1.0);
  all += chart("what friction could still bear [N]", of_grip(object, &ObjectSample::margin), axis, 0.1);
  all +=
      chart("times the load, force and torque together, that friction could bear (1: it slides; 5: or more)",
            of_grip(object, &ObjectSample::bearable, kMostShown), axis, 2.0);
  all += chart("torque about the grip [N m]", of_grip(object, &ObjectSample::torque), axis, 1e-3);
  return all + chart("speed of the palm [m/s]; orange: not seen by the tracker", speeds(story), axis, 0.1);
}

std::string finger_legend() {
  std::string text = "<p>";
  for (int finger = 0; finger <= kFingers; ++finger)
    text += std::string("<span style='color:") + kColors[finger] + "'>&#9632; " +
            finger_name(capsule_index(finger, 0)) + "</span> ";
  return text + "</p>\n";
}

}  // namespace

std::string to_html(const Explanation& explanation) {
  std::string page =
      "<!DOCTYPE html>\n<html lang='en'><head><meta charset='utf-8'><title>Why it "
      "slipped</title><style>body{font:14px "
      "sans-serif;max-width:940px;margin:1em auto;color:#222}text{font-size:11px;fill:#444}svg{display:block;"
      "margin:4px 0}.picture{display:inline-block;border:1px solid #ddd;margin:2px}</style></head><body>\n";
  page += "<h1>" + escaped(explanation.input) + "</h1>\n";
  page += explanation.losses.empty() ? "<p>Nothing that was held has been lost.</p>\n"
                                     : "<h2>What was lost</h2>\n";
  for (const Loss& loss : explanation.losses) page += loss_section(explanation, loss);
  page += finger_legend();
  for (const auto& [name, object] : explanation.objects) page += object_section(explanation, name, object);
  return page + "</body></html>\n";
}

}  // namespace mrhi
