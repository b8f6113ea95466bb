#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

#include "../text/text.h"
#include "marker_layers.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"

namespace mrhi {
namespace {

using visualization_msgs::Marker;
using Status = mr_hand_interaction::TrainingStatus;

constexpr double kTextHeight = 0.0125, kSmallTextHeight = 0.0110;  // height of letters [m]
constexpr double kTimerHeight = 0.02;                              // of the timer's letters [m]
constexpr double kNumberHeight = 0.014;                            // of a place's number [m]
constexpr double kNumberDistance = 1.35;  // from a target to its number, over its ring's radius
constexpr double kLineSpacing = 1.4;      // line spacing, over the letters' height
constexpr double kRingScale = 1.15;       // radius of the ring, over the body's bounding radius
constexpr double kRingWidth = 0.12;       // over its radius
constexpr double kShellScale = 1.12;      // size of a highlight, over the body's
constexpr double kArrowLength = 0.035;    // of the arrow that points at the object [m]
constexpr double kArrowGap = 0.012;       // between arrow and object [m]
constexpr int kIdsPerPlace = 100;
constexpr std::size_t kMaxLetters = 44;  // letters per line

/// 0.3 m in front of the camera of rviz/training.rviz, before the workspace of the hands.
const Vector3 kHeadingPlace(0.0, -0.193, 0.545), kTimerPlace(0.10, -0.212, 0.488);
const Vector3 kDown(0.0, -0.2955, -0.9553);  // in that view

/// Of a target.
std_msgs::ColorRGBA target_color(bool reached, double alpha) {
  return reached ? color(0.000, 0.620, 0.451, alpha) : color(0.337, 0.706, 0.914, alpha);
}

void write(const MarkerLayer& layer, int id, const Vector3& place, const std::string& text,
           double height = kTextHeight) {
  if (text.empty()) return;
  layer.add(id, Marker::TEXT_VIEW_FACING, {place}, Vector3::Constant(height), color(0.95, 0.95, 0.95)).text =
      text;
}

/// Breaks a text between words into lines of at most kMaxLetters letters.
std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (lines.empty() || lines.back().size() + 1 + word.size() > kMaxLetters) {
      lines.push_back(word);
    } else {
      lines.back() += ' ' + word;
    }
  }
  return lines;
}

/// Writes the heading, the text's lines below it, and then the progress or the last result.
void write_instruction(const MarkerLayer& layer, const MarkerLayer& below, const std::string& heading,
                       const std::string& text, const std::string& result) {
  Vector3 place = kHeadingPlace;
  int id = 0;
  write(layer, id++, place, heading, kSmallTextHeight);
  for (const std::string& line : lines_of(text))
    write(layer, id++, place += kLineSpacing * kTextHeight * kDown, line);
  write(below, 0, place += kLineSpacing * kTextHeight * kDown, result, kSmallTextHeight);
}

Pose pose_at(const Goal& goal, const Session& session) {
  const Quaternion& any = session.object().start.orientation;
  return {goal.position, goal.angle_tolerance ? goal.orientation : any};
}

void add_places(const Session& session, const Body& body, const MarkerLayer& places,
                const MarkerLayer& path) {
  const Task& task = session.task();
  const bool begun = session.phase() != SessionPhase::ready;
  std::vector<Vector3> route{session.object().start.position};
  for (std::size_t i = 0; i < task.goals.size(); ++i) {
    const Goal& goal = task.goals[i];
    const std::size_t number = task.place_number(i);
    if (number == 0) continue;
    route.push_back(goal.position);
    const int id = static_cast<int>(i) * kIdsPerPlace;
    const bool done = begun && session.trial().goal() > i, waits = !begun || session.trial().goal() < i;
    const Vector3 in_front = goal.position - kNumberDistance * ring_radius(body) * Vector3::UnitY();
    write(places, id, in_front, done ? "done" : std::to_string(number), kNumberHeight);
    if (waits) add_target({body, pose_at(goal, session), 0.0, false, true}, id + 1, places);
  }
  if (route.size() < 2) return;
  Marker& line = path.add(0, Marker::LINE_STRIP, Pose{}, {0.001, 0.0, 0.0}, color(0.9, 0.9, 0.9, 0.4));
  for (const Vector3& point : route) line.points.push_back(to_message(point));
}

std::string heading(const Status& status) {
  return text::format("trial %u of %u: ", status.trial, status.trials) + text::with_spaces(status.object);
}

std::string timer_text(const Goal& goal, const Status& status) {
  const bool runs = status.phase == Status::RUNNING && status.progress > 0.0 && status.progress < 1.0;
  return runs && goal.kind != GoalKind::release ? text::format("%.1f s", status.remaining) : "";
}

std::string result_text(const Session& session, const Status& status) {
  if (status.phase == Status::RUNNING || status.phase == Status::PAUSED)
    return text::format("%.0f s, dropped: %u", status.elapsed, status.drops);
  if (!session.last()) return "";
  const TrialRow& last = *session.last();
  const TrialMeasures& measures = last.measures;
  const std::string line =
      text::with_spaces(last.object) + text::format(": %s, %.1f s, dropped: %d", to_string(last.result),
                                                    measures.completion_time, measures.drops);
  return measures.release_drift ? line + text::format(", drifted %.0f mm", 1e3 * *measures.release_drift)
                                : line;
}

/// Returns the next free id.
int add_form(const Body& body, const Pose& pose, const std_msgs::ColorRGBA& paint, double size, int id,
             const MarkerLayer& layer) {
  for (const Visual& drawn : drawn_shapes(body)) {
    Marker& marker = add_shape(drawn.shape, pose * drawn.pose, paint, id++, layer);
    for (double* const scale : {&marker.scale.x, &marker.scale.y, &marker.scale.z}) *scale *= size;
  }
  return id;
}

}  // namespace

std::string instruction_now(const Session& session, bool paused, bool begins_by_itself) {
  if (session.phase() == SessionPhase::finished) return "All trials are done: two questions remain.";
  if (paused) return "Pause";
  if (session.phase() == SessionPhase::ready)
    return begins_by_itself ? "Get ready: " + session.task().instructions : session.task().instructions;
  return instruction(session.task(), session.trial().goal(), session.object().name);
}

visualization_msgs::MarkerArray training_markers(
    const Session& session, const Body& body, const Status& status,
    const std::optional<mr_hand_interaction::ObjectState>& seen) {
  visualization_msgs::MarkerArray array;
  const MarkerLayers layers{array, status.header};
  const MarkerLayer target = layers.layer("target");
  const bool active = status.phase == Status::RUNNING || status.phase == Status::PAUSED;
  const Goal& goal = session.task().goals[session.trial().goal()];
  const bool comes_to_rest =
      goal.kind == GoalKind::rest && !goal.of_operator && std::isfinite(goal.tolerance);
  const bool somewhere =
      goal.kind == GoalKind::nudge_into || comes_to_rest || goal.stage == TrainingStage::maintenance;
  if (active && somewhere) {
    if (goal.kind == GoalKind::nudge_into) {
      target.add(0, Marker::CUBE, {goal.position}, goal.size,
                 status.inside ? target_color(true, 0.6) : target_color(false, 0.35));
    } else {
      add_target({body, pose_at(goal, session), status.progress, status.inside != 0}, 0, target);
    }
    write(layers.layer("timer"), 0, kTimerPlace, timer_text(goal, status), kTimerHeight);
  }
  if (status.phase != Status::FINISHED)
    add_places(session, body, layers.layer("places"), layers.layer("path"));
  if (status.phase == Status::RUNNING && seen && !seen->held && goal.stage != TrainingStage::release)
    add_highlight(body, from_message(seen->pose), 0, layers.layer("object"));
  write_instruction(layers.layer("instructions"), layers.layer("result"), heading(status), status.instruction,
                    result_text(session, status));
  return array;
}

void add_target(const TargetMark& target, int first_id, const MarkerLayer& layer) {
  const double form = target.waits ? 0.12 : 0.35, filled = target.waits ? 0.25 : 1.0;
  const int id = add_form(target.body, target.pose, target_color(target.reached, form), 1.0, first_id, layer);
  Marker& ring = layer.add(id, Marker::TRIANGLE_LIST, Pose{}, Vector3::Ones(), color(1.0, 1.0, 1.0));
  const double inner = ring_radius(target.body), outer = (1.0 + kRingWidth) * inner;
  const double progress = std::min(1.0, std::max(0.0, target.progress));
  add_ring({inner, outer, 0.0, progress}, {target.pose.position}, ring);
  ring.colors.resize(ring.points.size(), target_color(target.reached, filled));
  add_ring({inner, outer, progress, 1.0}, {target.pose.position}, ring);
  ring.colors.resize(ring.points.size(), color(0.9, 0.9, 0.9, 0.3 * filled));
}

double ring_radius(const Body& body) {
  return kRingScale * body.bounding_radius;
}

void add_highlight(const Body& body, const Pose& pose, int first_id, const MarkerLayer& layer) {
  const int id = add_form(body, pose, color(0.941, 0.894, 0.259, 0.45), kShellScale, first_id, layer);
  const Vector3 tip = pose.position + (body.bounding_radius + kArrowGap) * Vector3::UnitZ();
  add_arrow({tip + kArrowLength * Vector3::UnitZ(), tip, 0.003, 0.008, 0.018}, color(0.941, 0.894, 0.259), id,
            layer);
}

}  // namespace mrhi
