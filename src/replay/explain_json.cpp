#include <cmath>

#include "explain.h"
#include "json_text.h"
#include "result_writer.h"

namespace mrhi {
namespace {

using Members = std::vector<std::pair<std::string, std::string>>;

/// Micro-units are enough here: the tables have all digits.
std::string rounded(double value) {
  return json::number(std::round(value * 1e6) / 1e6);
}

template <typename Item, typename AsJson>
std::string list_of(const std::vector<Item>& items, AsJson as_json) {
  std::vector<std::string> texts;
  texts.reserve(items.size());
  for (const Item& item : items) texts.push_back(as_json(item));
  return json::list(texts);
}

std::string line_of_time(const std::vector<ObjectSample>& samples) {
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < samples.size();) {
    std::size_t end = i;
    while (end < samples.size() && samples[end].course == samples[i].course) ++end;
    const double until = samples[std::min(end, samples.size() - 1)].time;
    parts.push_back(json::object({{"state", json::quoted(to_string(samples[i].course))},
                                  {"from", rounded(samples[i].time)},
                                  {"until", rounded(until)}}));
    i = end;
  }
  return json::list(parts);
}

std::string finger_json(const ObjectSample& sample, const FingerTouch& touch) {
  return json::object({{"time", rounded(sample.time)},
                       {"hand_id", std::to_string(touch.hand_id)},
                       {"finger", json::quoted(finger_name(capsule_index(touch.finger, 0)))},
                       {"normal_force", rounded(touch.normal)},
                       {"tangential_force", rounded(touch.tangential)},
                       {"friction_limit", rounded(touch.limit)},
                       {"share", rounded(touch.share())},
                       {"slips", touch.slips ? "true" : "false"},
                       {"depth", rounded(touch.depth)},
                       {"face", json::quoted(touch.face)}});
}

std::string fingers_json(const std::vector<ObjectSample>& samples) {
  std::vector<std::string> rows;
  for (const ObjectSample& sample : samples)
    for (const FingerTouch& touch : sample.fingers) rows.push_back(finger_json(sample, touch));
  return json::list(rows);
}

constexpr double kMost = 1e3;  // times the load: there is none worth naming

std::string grip_json(const std::vector<ObjectSample>& samples) {
  std::vector<std::string> rows;
  for (const ObjectSample& sample : samples) {
    if (sample.fingers.empty()) continue;
    rows.push_back(json::object({{"time", rounded(sample.time)},
                                 {"torque", rounded(sample.torque)},
                                 {"margin", rounded(sample.margin)},
                                 {"bearable", sample.bearable < kMost ? rounded(sample.bearable) : "null"},
                                 {"helped", sample.helped ? "true" : "false"}}));
  }
  return json::list(rows);
}

std::string object_json(const std::string& name, const ObjectStory& story) {
  return json::object({{"name", json::quoted(name)},
                       {"mass", json::number(story.mass)},
                       {"static_friction", json::number(story.material.static_friction)},
                       {"dynamic_friction", json::number(story.material.dynamic_friction)},
                       {"joint", story.joint.empty() ? "null" : json::quoted(story.joint)},
                       {"line", line_of_time(story.samples)},
                       {"fingers", fingers_json(story.samples)},
                       {"grip", grip_json(story.samples)}});
}

std::string hand_json(std::uint32_t id, const std::vector<HandSample>& samples) {
  const auto row = [](const HandSample& sample) {
    return json::object({{"time", rounded(sample.time)},
                         {"speed", rounded(sample.speed)},
                         {"confidence", rounded(sample.confidence)},
                         {"lost", sample.lost ? "true" : "false"}});
  };
  return json::object({{"id", std::to_string(id)}, {"samples", list_of(samples, row)}});
}

std::string loss_json(const Loss& loss) {
  Members members{{"object", json::quoted(loss.object)},
                  {"hand_id", std::to_string(loss.hand_id)},
                  {"grasped", loss.grasped ? "true" : "false"},
                  {"from", rounded(loss.from)},
                  {"until", rounded(loss.until)},
                  {"cause", json::quoted(to_string(loss.cause))},
                  {"push", rounded(loss.push)},
                  {"load", rounded(loss.load)},
                  {"friction", rounded(loss.friction)},
                  {"friction_needed", rounded(loss.friction_needed)},
                  {"push_needed", rounded(loss.push_needed)}};
  if (loss.cause == LossCause::hand_opened) members.emplace_back("opened", rounded(loss.opened));
  if (!loss.by.empty()) members.emplace_back("by", json::quoted(loss.by));
  members.emplace_back("text", json::quoted(loss.text));
  return json::object(members);
}

std::string touch_json(const Touch& touch) {
  const auto name = [](int finger) { return json::quoted(finger_name(capsule_index(finger, 0))); };
  return json::object({{"object", json::quoted(touch.object)},
                       {"hand_id", std::to_string(touch.hand_id)},
                       {"from", rounded(touch.from)},
                       {"until", rounded(touch.until)},
                       {"fingers", list_of(touch.fingers, name)},
                       {"speed", rounded(touch.speed)}});
}

std::string joint_json(const std::string& name, const JointStory& joint) {
  const auto row = [](const JointSample& sample) {
    return json::object({{"time", rounded(sample.time)}, {"position", rounded(sample.position)}});
  };
  return json::object({{"name", json::quoted(name)},
                       {"object", json::quoted(joint.body)},
                       {"unit", json::quoted(joint.turns ? "rad" : "m")},
                       {"lower", json::number(joint.lower)},
                       {"upper", json::number(joint.upper)},
                       {"samples", list_of(joint.samples, row)}});
}

std::string event_json(const ToldEvent& event) {
  return json::object({{"time", rounded(event.time)},
                       {"kind", json::quoted(event_name(event.kind))},
                       {"object", json::quoted(event.object)},
                       {"hand_id", std::to_string(event.hand_id)}});
}

std::string vector_json(const Vector3& vector) {
  return json::list({rounded(vector.x()), rounded(vector.y()), rounded(vector.z())});
}

std::string moment_json(const PictureMoment& moment) {
  return json::object({{"what", json::quoted(to_string(moment.what))},
                       {"object", json::quoted(moment.object)},
                       {"time", rounded(moment.time)},
                       {"loss", moment.loss ? std::to_string(*moment.loss) : "null"},
                       {"place", vector_json(moment.place)},
                       {"palm", vector_json(moment.palm)},
                       {"across", vector_json(moment.across)},
                       {"radius", rounded(moment.radius)}});
}

}  // namespace

std::string to_json(const Explanation& explanation) {
  std::vector<std::string> objects, hands, joints;
  for (const auto& [name, story] : explanation.objects) objects.push_back(object_json(name, story));
  for (const auto& [id, samples] : explanation.hands) hands.push_back(hand_json(id, samples));
  for (const auto& [name, joint] : explanation.joints) joints.push_back(joint_json(name, joint));
  return json::object({{"input", json::quoted(explanation.input)},
                       {"facts", list_of(explanation.facts, json::quoted)},
                       {"losses", list_of(explanation.losses, loss_json)},
                       {"touches", list_of(explanation.touches, touch_json)},
                       {"moments", list_of(explanation.moments, moment_json)},
                       {"events", list_of(explanation.events, event_json)},
                       {"joints", json::list(joints)},
                       {"objects", json::list(objects)},
                       {"hands", json::list(hands)}}) +
         "\n";
}

}  // namespace mrhi
