#include "training_markers.h"

#include <algorithm>
#include <cstdio>

#include "marker_layers.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"

namespace mrhi {
namespace {

using visualization_msgs::Marker;
using Status = mr_hand_interaction::TrainingStatus;

constexpr double kPassing = 0.5;  // [s]
constexpr double kText = 0.014;   // height of letters [m]
constexpr double kMark = 0.012;   // of a place's number [m]

/// Behind and above what hands reach.
const Vector3 kInstructionPlace(0.0, 0.16, 0.45), kResultPlace(0.0, 0.16, 0.42);

std_msgs::ColorRGBA waiting() {
  return color(0.337, 0.706, 0.914, 0.35);
}
std_msgs::ColorRGBA lit() {
  return color(0.000, 0.620, 0.451, 0.6);
}
std_msgs::ColorRGBA white() {
  return color(0.95, 0.95, 0.95);
}

Pose upright(const Vector3& position) {
  return {position, Quaternion::Identity()};
}

void write(MarkerLayer& layer, int id, const Vector3& place, const std::string& text, double height = kText) {
  if (text.empty()) return;
  layer.add(id, Marker::TEXT_VIEW_FACING, upright(place), Vector3::Constant(height), white()).text = text;
}

/// Where the object is to be for a goal, if it is to be somewhere.
void add_goal(const Session& session, const Body& body, const Status& status, MarkerLayer& layer) {
  const Goal& goal = session.task().goals[session.trial().goal()];
  if (goal.kind == GoalKind::nudge_into) {
    layer.add(0, Marker::CUBE, upright(goal.position), goal.size, status.inside ? lit() : waiting());
    return;
  }
  const Quaternion& any = session.object().start.orientation;
  const Pose pose{goal.position, goal.angle_tolerance ? goal.orientation : any};
  add_target({body, pose, status.progress, status.inside != 0}, 0, layer);
}

void add_places(const Session& session, MarkerLayer& places, MarkerLayer& path) {
  const Task& task = session.task();
  std::vector<Vector3> way{session.object().start.position};
  for (std::size_t i = 0; i < task.goals.size(); ++i) {
    const std::size_t number = task.place_number(i);
    if (number == 0) continue;
    way.push_back(task.goals[i].position);
    const bool done = session.phase() != SessionPhase::ready && session.trial().goal() > i;
    write(places, static_cast<int>(i), way.back(), done ? "done" : std::to_string(number), kMark);
  }
  if (way.size() < 2) return;
  Marker& line = path.add(0, Marker::LINE_STRIP, Pose{}, {0.001, 0.0, 0.0}, color(0.9, 0.9, 0.9, 0.4));
  for (const Vector3& point : way) line.points.push_back(to_message(point));
}

std::string heading(const Status& status) {
  char text[160];
  std::snprintf(text, sizeof text, "trial %u of %u: %s", status.trial, status.trials, status.object.c_str());
  return text;
}

std::string timer_text(const Goal& goal, const Status& status) {
  char text[64] = "";
  const bool runs = status.progress > 0.0 && status.progress < 1.0;
  if (status.phase == Status::RUNNING && runs && goal.kind != GoalKind::release)
    std::snprintf(text, sizeof text, "%.1f s", status.remaining);
  return text;
}

std::string result_text(const Session& session, const Status& status) {
  char text[160] = "";
  if (status.phase == Status::RUNNING || status.phase == Status::PAUSED) {
    std::snprintf(text, sizeof text, "%.0f s, dropped: %u", status.elapsed, status.drops);
  } else if (session.last()) {
    const TrialRow& last = *session.last();
    std::snprintf(text, sizeof text, "%s: %s, %.1f s, dropped: %d", last.object.c_str(),
                  to_string(last.result), last.measures.completion_time, last.measures.drops);
    std::string line = text;
    if (last.measures.release_drift) {
      std::snprintf(text, sizeof text, ", drifted %.0f mm", 1e3 * *last.measures.release_drift);
      line += text;
    }
    return line;
  }
  return text;
}

}  // namespace

std::string instruction_now(const Session& session, bool paused, bool begins_by_itself) {
  if (session.phase() == SessionPhase::finished) return "All trials are done. Thank you!";
  if (paused) return "Pause";
  if (session.phase() == SessionPhase::ready)
    return begins_by_itself ? "Get ready: " + session.task().instructions : session.task().instructions;
  return instruction(session.task(), session.trial().goal(), session.object().name);
}

visualization_msgs::MarkerArray training_markers(const Session& session, const Body& body,
                                                 const Status& status) {
  visualization_msgs::MarkerArray array;
  const auto layer = [&](const char* name) { return MarkerLayer(array, status.header, name, kPassing); };
  MarkerLayer target = layer("target"), places = layer("places"), path = layer("path");
  MarkerLayer instructions = layer("instructions"), timer = layer("timer"), result = layer("result");
  const bool active = status.phase == Status::RUNNING || status.phase == Status::PAUSED;
  const Goal& goal = session.task().goals[session.trial().goal()];
  const bool somewhere = goal.kind == GoalKind::nudge_into || goal.stage == TrainingStage::maintenance;
  if (active && somewhere) {
    add_goal(session, body, status, target);
    const Vector3 above = goal.position + (1.3 * body.bounding_radius + kText) * Vector3::UnitZ();
    write(timer, 0, above, timer_text(goal, status));
  }
  if (status.phase != Status::FINISHED) add_places(session, places, path);
  write(instructions, 0, kInstructionPlace, status.instruction);
  write(instructions, 1, kInstructionPlace + 1.5 * kText * Vector3::UnitZ(), heading(status));
  write(result, 0, kResultPlace, result_text(session, status));
  return array;
}

}  // namespace mrhi
