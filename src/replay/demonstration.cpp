#include "demonstration.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "../simulation/contact_phase.h"
#include "../text/csv.h"
#include "result_writer.h"

namespace mrhi {
namespace {

const char* const kSides[] = {"left", "right"};

void add_contacts(const Simulation& simulation, DemonstrationFrame& frame) {
  const Scene& scene = simulation.scene();
  for (const Contact& contact : simulation.result().contacts) {
    const Body& body = scene.bodies[contact.key.body];
    if (body.fixed) continue;
    DemonstratedObject& object = frame.objects[body.name];
    object.force += contact.force;
    object.torque += (contact.point - object.pose.position).cross(contact.force);
  }
}

void add_events(const Simulation& simulation, DemonstrationFrame& frame) {
  for (const Event& event : simulation.result().events) {
    std::string text = event_name(event.kind);
    if (event.body >= 0) text += " " + simulation.scene().bodies[static_cast<std::size_t>(event.body)].name;
    frame.events.push_back(text);
  }
}

Pose between(const Pose& a, const Pose& b, double share) {
  return {a.position + share * (b.position - a.position), a.orientation.slerp(share, b.orientation)};
}

DemonstrationFrame between(const DemonstrationFrame& a, const DemonstrationFrame& b, Nanoseconds stamp) {
  const double share = static_cast<double>(stamp - a.stamp) / static_cast<double>(b.stamp - a.stamp);
  DemonstrationFrame frame = a;
  frame.stamp = stamp;
  frame.events.clear();
  for (auto& [name, object] : frame.objects) {
    const auto next = b.objects.find(name);
    if (next != b.objects.end()) object.pose = between(object.pose, next->second.pose, share);
  }
  for (std::size_t side = 0; side < frame.hands.size(); ++side)
    if (a.hands[side] && b.hands[side]) frame.hands[side] = blend(*a.hands[side], *b.hands[side], share);
  return frame;
}

std::vector<std::string> names_in(const Demonstration& demonstration) {
  std::set<std::string> names;
  for (const DemonstrationFrame& frame : demonstration.frames())
    for (const auto& object : frame.objects) names.insert(object.first);
  return {names.begin(), names.end()};
}

bool has_side(const Demonstration& demonstration, std::size_t side) {
  return std::any_of(demonstration.frames().begin(), demonstration.frames().end(),
                     [&](const DemonstrationFrame& frame) { return frame.hands[side].has_value(); });
}

std::string columns(const std::string& of, const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += "," + of + "." + name;
  return text;
}

const std::vector<std::string> kObjectColumns{"px", "py", "pz", "qx", "qy", "qz", "qw",
                                              "fx", "fy", "fz", "tx", "ty", "tz", "held"};
const std::vector<std::string> kPalmColumns{"px", "py", "pz", "qx", "qy", "qz", "qw"};

/// Ends of the bones, from the palm outwards.
std::string finger_columns(const std::string& side) {
  std::string text;
  for (int capsule = 0; capsule < kPhalanges; ++capsule)
    text +=
        columns(side + "." + finger_name(capsule) + "_" + std::to_string(bone_of(capsule)), {"x", "y", "z"});
  return text;
}

void write_pose(const Pose& pose, CsvFile& file) {
  const Quaternion& q = pose.orientation;
  file << pose.position << q.x() << q.y() << q.z() << q.w();
}

void write_object(const DemonstrationFrame& frame, const std::string& name, CsvFile& file) {
  const auto found = frame.objects.find(name);
  if (found == frame.objects.end()) return file.skip(kObjectColumns.size());
  write_pose(found->second.pose, file);
  file << found->second.force << found->second.torque << (found->second.held ? 1 : 0);
}

void write_hand(const std::optional<Hand>& hand, CsvFile& file) {
  if (!hand) return file.skip(kPalmColumns.size() + 3 * kPhalanges);
  write_pose(hand->palm, file);
  for (int capsule = 0; capsule < kPhalanges; ++capsule) {
    if (hand->has(capsule)) {
      file << hand->capsules[static_cast<std::size_t>(capsule)].end;
    } else {
      file.skip(3);
    }
  }
}

std::string joined(const std::vector<std::string>& events) {
  std::string text;
  for (const std::string& event : events) text += (text.empty() ? "" : "; ") + event;
  return text;
}

}  // namespace

void Demonstration::watch(const Simulation& simulation) {
  const SimulationState& state = simulation.state();
  DemonstrationFrame frame;
  frame.stamp = simulation.result().stamp;
  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    const Body& body = simulation.scene().bodies[b];
    if (body.fixed) continue;
    DemonstratedObject& object = frame.objects[body.name];
    object.pose = state.bodies[b].pose;
    object.held = is_held(b, state);
  }
  add_contacts(simulation, frame);
  for (const Hand& hand : simulation.result().tracked) {
    auto& place = frame.hands[static_cast<std::size_t>(hand.side)];
    if (!place) place = hand;
  }
  add_events(simulation, frame);
  if (!frames_.empty() && frame.stamp <= frames_.back().stamp) frames_.clear();  // it has begun anew
  frames_.push_back(frame);
}

Demonstration Demonstration::at_rate(double rate) const {
  Demonstration even;
  if (frames_.empty()) return even;
  const auto period = static_cast<Nanoseconds>(std::llround(1e9 / rate));
  std::size_t next = 0, told = 0;
  for (Nanoseconds stamp = frames_.front().stamp; stamp <= frames_.back().stamp; stamp += period) {
    while (next < frames_.size() && frames_[next].stamp < stamp) ++next;
    DemonstrationFrame frame =
        frames_[next].stamp == stamp ? frames_[next] : between(frames_[next - 1], frames_[next], stamp);
    frame.events.clear();
    for (; told < frames_.size() && frames_[told].stamp <= stamp; ++told)
      frame.events.insert(frame.events.end(), frames_[told].events.begin(), frames_[told].events.end());
    even.frames_.push_back(frame);
  }
  return even;
}

std::vector<std::pair<std::string, double>> joint_angles(const Hand& hand) {
  std::vector<std::pair<std::string, double>> angles;
  for (int finger = 0; finger < kFingers; ++finger) {
    for (int bone = 1; bone < kBonesPerFinger; ++bone) {
      const int here = capsule_index(finger, bone), before = here - 1;
      if (!hand.has(here) || !hand.has(before)) continue;
      const Capsule &a = hand.capsules[static_cast<std::size_t>(before)],
                    &b = hand.capsules[static_cast<std::size_t>(here)];
      const Vector3 u = a.end - a.start, v = b.end - b.start;
      if (u.norm() < 1e-6 || v.norm() < 1e-6)
        continue;  // the thumb has no metacarpal of a length with some trackers
      angles.emplace_back(std::string(finger_name(here)) + "_" + std::to_string(bone),
                          std::atan2(u.cross(v).norm(), u.dot(v)));
    }
  }
  return angles;
}

void write_demonstration_csv(const Demonstration& demonstration, const std::string& path) {
  const std::vector<std::string> names = names_in(demonstration);
  std::string header = "time";
  for (const std::string& name : names) header += columns(name, kObjectColumns);
  for (std::size_t side = 0; side < 2; ++side)
    if (has_side(demonstration, side))
      header += columns(std::string(kSides[side]) + ".palm", kPalmColumns) + finger_columns(kSides[side]);
  CsvFile file(path, header + ",events");
  for (const DemonstrationFrame& frame : demonstration.frames()) {
    file << to_seconds(frame.stamp - demonstration.frames().front().stamp);
    for (const std::string& name : names) write_object(frame, name, file);
    for (std::size_t side = 0; side < 2; ++side)
      if (has_side(demonstration, side)) write_hand(frame.hands[side], file);
    file << joined(frame.events);
    file.end_row();
  }
  file.flush();
}

}  // namespace mrhi
