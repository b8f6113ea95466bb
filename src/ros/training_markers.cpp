#include "training_markers.h"

#include <algorithm>
#include <cstdio>
#include <sstream>
#include <vector>

#include "../text/text.h"
#include "marker_layers.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"

namespace mrhi {
namespace {

using visualization_msgs::Marker;
using Status = mr_hand_interaction::TrainingStatus;

constexpr double kPassing = 0.5;                     // [s]
constexpr double kText = 0.016, kSmallText = 0.013;  // height of letters [m]
constexpr double kMark = 0.014;                      // of a place's number [m]
constexpr double kLine = 1.5;                        // from line to line, of the letters' height
constexpr std::size_t kLongest = 56;                 // letters in a line

/// Behind and above what hands reach: the last line of the instruction, and what is below it.
const Vector3 kInstructionPlace(0.0, 0.16, 0.45), kResultPlace(0.0, 0.16, 0.425);

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

/// In lines of at most kLongest letters, broken between words.
std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (lines.empty() || lines.back().size() + 1 + word.size() > kLongest) {
      lines.push_back(word);
    } else {
      lines.back() += ' ' + word;
    }
  }
  return lines;
}

/// The text's lines upward from the place, and the heading above them.
void write_instruction(MarkerLayer& layer, const std::string& heading, const std::string& text) {
  std::vector<std::string> lines = lines_of(text);
  Vector3 place = kInstructionPlace;
  int id = 0;
  for (auto line = lines.rbegin(); line != lines.rend(); ++line, place.z() += kLine * kText)
    write(layer, id++, place, *line);
  write(layer, id, place, heading, kSmallText);
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
  char buffer[160];
  std::snprintf(buffer, sizeof buffer, "trial %u of %u: %s", status.trial, status.trials,
                text::with_spaces(status.object).c_str());
  return buffer;
}

std::string timer_text(const Goal& goal, const Status& status) {
  char buffer[64] = "";
  const bool runs = status.progress > 0.0 && status.progress < 1.0;
  if (status.phase == Status::RUNNING && runs && goal.kind != GoalKind::release)
    std::snprintf(buffer, sizeof buffer, "%.1f s", status.remaining);
  return buffer;
}

std::string result_text(const Session& session, const Status& status) {
  char buffer[160] = "";
  if (status.phase == Status::RUNNING || status.phase == Status::PAUSED) {
    std::snprintf(buffer, sizeof buffer, "%.0f s, dropped: %u", status.elapsed, status.drops);
  } else if (session.last()) {
    const TrialRow& last = *session.last();
    std::snprintf(buffer, sizeof buffer, "%s: %s, %.1f s, dropped: %d",
                  text::with_spaces(last.object).c_str(), to_string(last.result),
                  last.measures.completion_time, last.measures.drops);
    std::string line = buffer;
    if (last.measures.release_drift) {
      std::snprintf(buffer, sizeof buffer, ", drifted %.0f mm", 1e3 * *last.measures.release_drift);
      line += buffer;
    }
    return line;
  }
  return buffer;
}

}  // namespace

std::string instruction_now(const Session& session, bool paused, bool begins_by_itself) {
  if (session.phase() == SessionPhase::finished) return "All trials are done: two questions remain.";
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
    const Vector3 beside = goal.position + (1.4 * body.bounding_radius + 2.0 * kText) * Vector3::UnitX();
    write(timer, 0, beside, timer_text(goal, status));
  }
  if (status.phase != Status::FINISHED) add_places(session, places, path);
  write_instruction(instructions, heading(status), status.instruction);
  write(result, 0, kResultPlace, result_text(session, status), kSmallText);
  return array;
}

}  // namespace mrhi
