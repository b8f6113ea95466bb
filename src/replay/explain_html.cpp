#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "explain.h"
#include "explain_chart.h"
#include "result_writer.h"

namespace mrhi {
namespace {

constexpr double kMostShown = 5.0;  // times the load
constexpr double kMostShare = 2.0;  // of the friction limit: help and edges bear more
constexpr double kLookBack = 1.0;   // before a loss [s]
constexpr std::size_t kMostTouches = 20;

const char* const kStyle =
    "body{font:14px/1.45 sans-serif;max-width:960px;margin:1.5em auto;padding:0 8px;color:#222}"
    "h1{font-size:22px;margin-bottom:2px}h2{font-size:18px;margin:1.4em 0 .3em;border-bottom:1px solid #ccc}"
    "h3{font-size:15px;margin:.2em 0}text{font-size:11px;fill:#555}.title text{font-size:12px;fill:#222;"
    "font-weight:bold}svg{display:block;margin:3px 0;max-width:100%}.facts{color:#555;margin:0;padding-left:"
    "1.2em}section{border:1px solid #ddd;border-radius:6px;padding:8px 10px;margin:10px 0}.cause{background:"
    "#fbe3d6;border-radius:4px;padding:1px 7px;font-size:12px;margin-left:8px}.row{display:flex;flex-wrap:"
    "wrap;gap:6px}figure{margin:0}figcaption{font-size:11px;color:#555}.drawing{border:1px solid #e2e2e2;"
    "display:inline-block;margin:0}img{display:block;border-radius:4px}.key{font-size:12px}";

const char* color_of(Course course) {
  constexpr const char* kCourses[] = {"#f0f0f0", "#f3dfa2", "#9fd6c2", "#e69f00", "#c5d3ea"};
  return kCourses[static_cast<std::size_t>(course)];
}

/// Stretches of samples that are alike by `key`, which is empty where there is none.
template <class Sample>
std::vector<Stretch> stretches(const std::vector<Sample>& samples,
                               const std::function<Stretch(const Sample&)>& look) {
  std::vector<Stretch> all;
  bool open = false;
  for (const Sample& sample : samples) {
    const Stretch now = look(sample);
    if (open) all.back().until = sample.time;
    if (now.color.empty()) {
      open = false;
      continue;
    }
    if (open && all.back().name == now.name) continue;
    all.push_back(now);
    all.back().from = all.back().until = sample.time;
    open = true;
  }
  return all;
}

std::string line_of_time(const ObjectStory& story, const TimeAxis& axis) {
  const Strip strip{"", stretches<ObjectSample>(story.samples, [](const ObjectSample& sample) -> Stretch {
                      const std::string name = to_string(sample.course);
                      return {0.0, 0.0, color_of(sample.course), name, name};
                    })};
  Strip help{"help", stretches<ObjectSample>(story.samples, [](const ObjectSample& sample) -> Stretch {
               if (!sample.helped) return {};
               return {0.0, 0.0, "#d7c4e8", "contact/grasp_assist bears it", "grasp_assist"};
             })};
  std::vector<Strip> strips{strip};
  if (!help.stretches.empty()) strips.push_back(help);
  return drawn("free, contact, hold, slip (all fingers slide), drop", strips, axis);
}

const FingerTouch* touch_in(const ObjectSample& sample, int finger) {
  for (const FingerTouch& touch : sample.fingers)
    if (touch.finger == finger) return &touch;
  return nullptr;
}

Stretch stick_or_slip(const ObjectSample& sample, int finger) {
  const FingerTouch* touch = touch_in(sample, finger);
  if (touch == nullptr) return {};
  const std::string what = touch->slips ? "slips" : "sticks";
  return {0.0, 0.0, touch->slips ? "#f0e442" : "#9fd6c2", what + " on " + touch->face, touch->face};
}

std::string fingers_strip(const ObjectStory& story, const TimeAxis& axis) {
  std::vector<Strip> strips;
  for (int finger = 0; finger <= kFingers; ++finger) {
    Strip strip{finger_name(capsule_index(finger, 0)),
                stretches<ObjectSample>(story.samples, [finger](const ObjectSample& sample) {
                  return stick_or_slip(sample, finger);
                })};
    const bool seen = std::any_of(strip.stretches.begin(), strip.stretches.end(), [&](const Stretch& s) {
      return s.until >= axis.from && s.from <= axis.until;
    });
    if (seen) strips.push_back(strip);
  }
  return strips.empty() ? "" : drawn("sticks (green) or slips (yellow), and on which face", strips, axis);
}

std::vector<Curve> of_fingers(const ObjectStory& story,
                              const std::function<double(const FingerTouch&)>& value) {
  std::vector<Curve> curves;
  for (int finger = 0; finger <= kFingers; ++finger) curves.push_back({finger_color(finger), {}});
  for (const ObjectSample& sample : story.samples)
    for (const FingerTouch& touch : sample.fingers)
      curves[static_cast<std::size_t>(touch.finger)].points.emplace_back(sample.time, value(touch));
  return curves;
}

std::vector<Curve> of_grip(const ObjectStory& story, double ObjectSample::*member, double most = 1e9) {
  Curve curve{"#333333", {}};
  for (const ObjectSample& sample : story.samples)
    if (!sample.fingers.empty())
      curve.points.emplace_back(sample.time, std::min(most, std::abs(sample.*member)));
  return {curve};
}

std::string push_chart(const ObjectStory& object, const TimeAxis& axis) {
  return drawn({"push of each finger [N]",
                of_fingers(object, [](const FingerTouch& t) { return t.normal; }),
                0.1,
                1e30,
                {}},
               axis);
}

std::string share_chart(const ObjectStory& object, const TimeAxis& axis) {
  return drawn(
      {"share of the friction limit (dashed: 1, where it slides; more where help or an edge bears it)",
       of_fingers(object, [](const FingerTouch& t) { return t.share(); }),
       1.2,
       kMostShare,
       {1.0}},
      axis);
}

std::string finger_legend() {
  std::string text = "<p class='key'>";
  for (int finger = 0; finger <= kFingers; ++finger)
    text += std::string("<span style='color:") + finger_color(finger) + "'>&#9632;</span> " +
            finger_name(capsule_index(finger, 0)) + " &nbsp; ";
  return text + "</p>\n";
}

// What all charts show behind their curves.

void shade_lost_hands(const Explanation& story, TimeAxis& axis) {
  for (const auto& [id, samples] : story.hands) {
    const auto lost = stretches<HandSample>(samples, [](const HandSample& sample) -> Stretch {
      if (!sample.lost) return {};
      return {0.0, 0.0, "x", "x", ""};
    });
    for (const Stretch& stretch : lost)
      axis.shades.push_back({stretch.from, stretch.until, "hand " + std::to_string(id) + " was not seen"});
  }
}

/// Between frames that are apart by three times what they mostly are.
std::vector<TimeAxis::Shade> gaps_of(const std::vector<double>& times) {
  std::vector<double> apart;
  for (std::size_t i = 1; i < times.size(); ++i) apart.push_back(times[i] - times[i - 1]);
  if (apart.empty()) return {};
  std::nth_element(apart.begin(), apart.begin() + static_cast<std::ptrdiff_t>(apart.size() / 2), apart.end());
  const double usual = apart[apart.size() / 2];
  std::vector<TimeAxis::Shade> gaps;
  for (std::size_t i = 1; i < times.size(); ++i)
    if (times[i] - times[i - 1] > 3.0 * usual) gaps.push_back({times[i - 1], times[i], "no frame"});
  return gaps;
}

TimeAxis axis_of(const Explanation& story, const std::string& object, double from, double until) {
  TimeAxis axis{from, until, {}, gaps_of(story.times)};
  shade_lost_hands(story, axis);
  for (const ToldEvent& event : story.events)
    if (event.object == object && event.kind == EventKind::grasp_begin)
      axis.marks.push_back({event.time, "#009e73", "grasp begins at " + short_number(event.time) + " s"});
  for (const Loss& loss : story.losses)
    if (loss.object == object)
      axis.marks.push_back({loss.until, "#d55e00", "last touch at " + short_number(loss.until) + " s"});
  return axis;
}

/// Where the pictures of moments are put that `wanted` holds of.
std::string places_of_pictures(const Explanation& story,
                               const std::function<bool(const PictureMoment&)>& wanted) {
  std::string all;
  for (std::size_t i = 0; i < story.moments.size(); ++i)
    if (wanted(story.moments[i])) all += "<!--picture " + std::to_string(i) + "-->";
  return all.empty() ? "" : "<div class='row'>" + all + "</div>\n";
}

std::string words(const char* name) {
  std::string text = name;
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

std::string loss_section(const Explanation& story, std::size_t index) {
  const Loss& loss = story.losses[index];
  const ObjectStory& object = story.objects.at(loss.object);
  std::string all = "<section id='loss" + std::to_string(index) + "'><h3>" + escaped(loss.object) + ", " +
                    short_number(loss.until) + " s<span class='cause'>" + words(to_string(loss.cause)) +
                    "</span></h3><p>" + escaped(loss.text) + "</p>\n";
  all += places_of_pictures(story, [&](const PictureMoment& moment) { return moment.loss == index; });
  const TimeAxis axis = axis_of(story, loss.object, std::max(loss.from - 0.1, loss.until - kLookBack),
                                std::min(object.samples.back().time, loss.until + 0.1));
  all += finger_legend() + push_chart(object, axis) + share_chart(object, axis) + fingers_strip(object, axis);
  return all + "<div class='row'>" + drawings_of(story, loss) + "</div></section>\n";
}

std::string touch_line(const Touch& touch) {
  std::string fingers;
  for (const int finger : touch.fingers) fingers += (fingers.empty() ? "" : ", ") + finger_text(finger);
  return "<li>" + escaped(touch.object) + ", " + short_number(touch.from) + " to " +
         short_number(touch.until) + " s: " + fingers + " touched it, and it left faster by " +
         short_number(touch.speed) + " m/s</li>";
}

std::string touches_section(const Explanation& story) {
  if (story.touches.empty()) return "";
  std::string all = "<h2>Touched, and not held</h2><ul>";
  for (std::size_t i = 0; i < std::min(story.touches.size(), kMostTouches); ++i)
    all += touch_line(story.touches[i]);
  if (story.touches.size() > kMostTouches)
    all += "<li>and " + std::to_string(story.touches.size() - kMostTouches) + " more, in explain.json</li>";
  return all + "</ul>\n";
}

bool is_touched(const ObjectStory& object) {
  return std::any_of(object.samples.begin(), object.samples.end(),
                     [](const ObjectSample& sample) { return !sample.fingers.empty(); });
}

std::string object_section(const Explanation& story, const std::string& name, const ObjectStory& object) {
  const TimeAxis axis = axis_of(story, name, object.samples.front().time, object.samples.back().time);
  std::string all = "<h2>" + escaped(name) + "</h2><p class='key'>" + short_number(object.mass) +
                    " kg, friction " + short_number(object.material.static_friction) + " at rest, " +
                    short_number(object.material.dynamic_friction) + " sliding" +
                    (object.joint.empty() ? "" : ", on joint " + escaped(object.joint)) +
                    ". Dashed: <span style='color:#009e73'>a grasp begins</span>, <span "
                    "style='color:#d55e00'>last touch</span>; shaded: hand or frames not seen.</p>\n";
  all += places_of_pictures(
      story, [&](const PictureMoment& moment) { return moment.object == name && !moment.loss; });
  all += line_of_time(object, axis) + finger_legend() + push_chart(object, axis) + share_chart(object, axis);
  all += fingers_strip(object, axis);
  all += drawn({"depth of each finger [mm]",
                of_fingers(object, [](const FingerTouch& t) { return 1e3 * t.depth; }),
                1.0,
                1e30,
                {}},
               axis);
  all += drawn({"what friction could still bear of a straight pull [N]",
                of_grip(object, &ObjectSample::margin),
                0.1,
                1e30,
                {}},
               axis);
  all += drawn({"how many times the load, force and torque together, friction could bear (dashed: 1, where "
                "it slides; 5: or more)",
                of_grip(object, &ObjectSample::bearable, kMostShown),
                2.0,
                kMostShown,
                {1.0}},
               axis);
  return all + drawn({"torque about the line through the grip [N m]",
                      of_grip(object, &ObjectSample::torque),
                      1e-3,
                      1e30,
                      {}},
                     axis);
}

// Joints.

std::string turned_by(const JointStory& joint, double by) {
  if (!joint.turns) return short_number(1e3 * by) + " mm";
  return short_number(by) + " rad (" + short_number(by * 180.0 / M_PI) + " degrees)";
}

std::string joint_text(const Explanation& story, const std::string& name, const JointStory& joint) {
  const auto by_position = [](const JointSample& a, const JointSample& b) { return a.position < b.position; };
  const auto [least, most] = std::minmax_element(joint.samples.begin(), joint.samples.end(), by_position);
  const double start = joint.samples.front().position, end = joint.samples.back().position;
  const JointSample& farthest =
      std::abs(most->position - start) >= std::abs(least->position - start) ? *most : *least;
  std::string text = "<b>" + escaped(name) + "</b> (" + escaped(joint.body) + "): moved by at most " +
                     turned_by(joint, farthest.position - start) + ", at " + short_number(farthest.time) +
                     " s; at the end by " + turned_by(joint, end - start) + ".";
  for (const ToldEvent& event : story.events) {
    const bool of_joint = event.kind == EventKind::joint_limit || event.kind == EventKind::detent ||
                          event.kind == EventKind::latch_open;
    if (of_joint && event.object == joint.body)
      text += std::string(" ") + event_name(event.kind) + " at " + short_number(event.time) + " s.";
  }
  return "<p>" + text + "</p>";
}

bool has_moved(const JointStory& joint) {
  return std::any_of(joint.samples.begin(), joint.samples.end(), [&](const JointSample& sample) {
    return std::abs(sample.position - joint.samples.front().position) > 1e-3;
  });
}

std::string joint_chart(const Explanation& story, const JointStory& joint) {
  TimeAxis axis = axis_of(story, joint.body, joint.samples.front().time, joint.samples.back().time);
  for (const ToldEvent& event : story.events) {
    const bool of_joint = event.kind == EventKind::joint_limit || event.kind == EventKind::detent ||
                          event.kind == EventKind::latch_open;
    if (of_joint && event.object == joint.body)
      axis.marks.push_back({event.time, "#0072b2", event_name(event.kind)});
  }
  Chart chart{std::string("position [") + (joint.turns ? "rad" : "m") +
                  "] (dashed across: limits; blue: JOINT_LIMIT, DETENT, LATCH_OPEN)",
              {{"#333333", {}}},
              joint.turns ? 0.1 : 0.005,
              1e30,
              {joint.lower, joint.upper}};
  for (const JointSample& sample : joint.samples)
    chart.curves.front().points.emplace_back(sample.time, sample.position);
  return drawn(chart, axis);
}

std::string joints_section(const Explanation& story) {
  if (story.joints.empty()) return "";
  std::string all = "<h2>Joints</h2>\n", still;
  for (const auto& [name, joint] : story.joints) {
    if (has_moved(joint)) all += joint_text(story, name, joint) + joint_chart(story, joint);
    if (!has_moved(joint)) still += (still.empty() ? "" : ", ") + name;
  }
  return all + (still.empty() ? "" : "<p>Not moved: " + escaped(still) + ".</p>\n");
}

// Hands.

std::string hand_charts(const Explanation& story, std::uint32_t id, const std::vector<HandSample>& samples) {
  TimeAxis axis{story.times.front(), story.times.back(), {}, gaps_of(story.times)};
  shade_lost_hands(story, axis);
  Curve speed{"#333333", {}}, confidence{"#0072b2", {}};
  for (const HandSample& sample : samples) {
    speed.points.emplace_back(sample.time, sample.speed);
    confidence.points.emplace_back(sample.time, sample.confidence);
  }
  const std::string hand = "hand " + std::to_string(id) + ": ";
  const bool told = std::any_of(samples.begin(), samples.end(),
                                [](const HandSample& sample) { return sample.confidence != 1.0; });
  std::string all = drawn({hand + "speed of the palm [m/s] (shaded: not seen by the tracker, or no frame)",
                           {speed},
                           0.1,
                           1e30,
                           {}},
                          axis);
  if (told) all += drawn({hand + "confidence of the tracker", {confidence}, 1.0, 1.0, {}}, axis);
  return all;
}

std::string losses_section(const Explanation& story) {
  std::string all = "<h2>What was lost or let go</h2>\n";
  if (story.losses.empty()) return all + "<p>Nothing that was held has been lost.</p>\n";
  for (std::size_t i = 0; i < story.losses.size(); ++i) all += loss_section(story, i);
  return all;
}

std::string objects_sections(const Explanation& story) {
  std::string all, untouched;
  for (const auto& [name, object] : story.objects) {
    if (object.samples.empty()) continue;
    if (is_touched(object)) all += object_section(story, name, object);
    if (!is_touched(object)) untouched += (untouched.empty() ? "" : ", ") + name;
  }
  if (!untouched.empty()) all += "<p>Touched by no hand: " + escaped(untouched) + ".</p>\n";
  return all;
}

std::string facts_list(const std::vector<std::string>& facts) {
  std::string all = "<ul class='facts'>";
  for (const std::string& fact : facts) all += "<li>" + escaped(fact) + "</li>";
  return all + "</ul>\n";
}

}  // namespace

std::string to_html(const Explanation& story) {
  std::string page = "<!DOCTYPE html>\n<html lang='en'><head><meta charset='utf-8'><title>Why it slipped: " +
                     escaped(story.input) + "</title><style>" + kStyle + "</style></head><body>\n";
  page += "<h1>Why it slipped</h1><p>" + escaped(story.input) + "</p>" + facts_list(story.facts);
  page += losses_section(story) + touches_section(story) + joints_section(story) + objects_sections(story);
  if (!story.hands.empty()) page += "<h2>Hands</h2>\n";
  for (const auto& [id, samples] : story.hands) page += hand_charts(story, id, samples);
  return page + "</body></html>\n";
}

}  // namespace mrhi
