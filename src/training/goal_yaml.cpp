
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "../text/text.h"
#include "task_values.h"

namespace mrhi::task_yaml {
namespace {

using Element = YamlElement;

constexpr double kDegree = M_PI / 180.0;
constexpr Range kJointPlace{-1e3, 1e3};

void speed_range(const Element& element, Goal& goal) {
  const char* const allowed = "[slowest, fastest] in m/s, slowest at least 0 and below fastest";
  if (!element.node.IsSequence() || element.node.size() != 2) element.refuse(allowed);
  const std::optional<double> slowest = yaml_number(element.node[0]), fastest = yaml_number(element.node[1]);
  if (!slowest || !fastest || *slowest < 0.0 || *slowest >= *fastest || !kAboveZero.contains(*fastest))
    element.refuse(allowed);
  goal.min_speed = *slowest;
  goal.max_speed = *fastest;
}

Vector3 box_size(const Element& element) {
  const Vector3 size = read_vector(element);
  if ((size.array() <= 0.0).any()) element.refuse("three numbers above 0, at most 1000 [m]");
  return size;
}

/// Keys of goals and what each sets.
const std::map<std::string, std::function<void(const Element&, Goal&)>>& goal_keys() {
  using E = const Element&;
  static const std::map<std::string, std::function<void(const Element&, Goal&)>> keys{
      {"instruction", [](E e, Goal& g) { g.instruction = string(e); }},
      {"position", [](E e, Goal& g) { g.position = read_vector(e); }},
      {"orientation", [](E e, Goal& g) { g.orientation = quaternion(e); }},
      {"tolerance", [](E e, Goal& g) { g.tolerance = number(e, kAboveZero, " [m]"); }},
      {"angle_tolerance",
       [](E e, Goal& g) {
         g.angle_tolerance = kDegree * number(e, {0.0, 180.0, false}, " [degrees]");
       }},
      {"axis", [](E e, Goal& g) { g.axis = unit_vector(e); }},
      {"size", [](E e, Goal& g) { g.size = box_size(e); }},
      {"hold", [](E e, Goal& g) { g.hold = number(e, kFromZero, " [s]"); }},
      {"leaving",
       [](E e, Goal& g) {
         g.leaving = choice(e, "reset", "stop") == "stop" ? Leaving::stop : Leaving::reset;
       }},
      {"distance", [](E e, Goal& g) { g.distance = number(e, kFromZero, " [m]"); }},
      {"within", [](E e, Goal& g) { g.within = number(e, kAboveZero, " [s]"); }},
      {"name", [](E e, Goal& g) { g.joint = name(e); }},
      {"above", [](E e, Goal& g) { g.above = number(e, kJointPlace, " [rad], [m]"); }},
      {"below", [](E e, Goal& g) { g.below = number(e, kJointPlace, " [rad], [m]"); }},
      {"max_speed", [](E e, Goal& g) { g.max_speed = number(e, kAboveZero, " [m/s]"); }},
      {"min_speed", [](E e, Goal& g) { g.min_speed = number(e, kAboveZero, " [m/s]"); }},
      {"speed", [](E e, Goal& g) { speed_range(e, g); }},
      {"max_spin", [](E e, Goal& g) { g.max_spin = number(e, kAboveZero, " [rad/s]"); }},
      {"body", [](E e, Goal& g) { g.of_operator = choice(e, "object", "operator") == "operator"; }},
      {"drift_time", [](E e, Goal& g) { g.drift_time = number(e, kFromZero, " [s]"); }},
  };
  return keys;
}

/// How a goal is written.
struct GoalForm {
  GoalKind kind;
  TrainingStage stage;
  std::vector<std::string> needed, optional;
  double hold = 0.0;
};

const std::map<std::string, GoalForm>& goal_forms() {
  using Kind = GoalKind;
  using Stage = TrainingStage;
  static const std::map<std::string, GoalForm> forms{
      {"pick", {Kind::pick, Stage::manipulation, {}, {"distance"}}},
      {"place",
       {Kind::place,
        Stage::maintenance,
        {"position"},
        {"orientation", "tolerance", "angle_tolerance", "axis", "hold", "leaving"},
        3.0}},
      {"insert",
       {Kind::insert,
        Stage::maintenance,
        {"position", "angle_tolerance"},
        {"orientation", "tolerance", "axis", "hold", "leaving"},
        3.0}},
      {"catch", {Kind::catch_it, Stage::manipulation, {"within"}, {"hold", "leaving"}, 1.0}},
      {"nudge_into",
       {Kind::nudge_into, Stage::manipulation, {"position", "size", "max_speed"}, {"hold", "leaving"}}},
      {"joint",
       {Kind::joint, Stage::manipulation, {"name"}, {"above", "below", "within", "hold", "leaving"}}},
      {"rest",
       {Kind::rest,
        Stage::manipulation,
        {},
        {"body", "position", "tolerance", "orientation", "angle_tolerance", "axis", "max_speed", "max_spin",
         "hold", "leaving"}}},
      {"tap", {Kind::strike, Stage::manipulation, {"speed"}, {}}},
      {"slap", {Kind::strike, Stage::manipulation, {"min_speed"}, {}}},
      {"release", {Kind::release, Stage::release, {}, {"drift_time"}}},
  };
  return forms;
}

void check_range(const Element& keys, const Goal& goal) {
  if (goal.above == -Joint::kUnlimited && goal.below == Joint::kUnlimited)
    keys.fail("neither above nor below; allowed: either, or both");
  if (goal.above > goal.below) keys.fail("above is more than below; allowed: at most as much");
}

void check_rest(const Element& keys, Goal& goal) {
  if (!keys.node["position"] && !keys.node["max_speed"] && !keys.node["max_spin"])
    keys.fail("neither position, max_speed nor max_spin; allowed: at least one of them");
  if (!keys.node["position"]) goal.tolerance = std::numeric_limits<double>::infinity();
}

std::vector<std::string> keys_of(const GoalForm& form) {
  std::vector<std::string> keys = form.needed;
  keys.insert(keys.end(), form.optional.begin(), form.optional.end());
  keys.push_back("instruction");
  return keys;
}

}  // namespace

Goal read_goal(const YamlElement& element) {
  std::vector<std::string> kinds;
  for (const auto& form : goal_forms()) kinds.push_back(form.first);
  if (!element.node.IsMap() || element.node.size() != 1)
    element.refuse("one kind of goal with its keys; kinds: " + text::joined(kinds));
  const std::string kind = checked_keys(element, kinds).front();
  const GoalForm& form = goal_forms().at(kind);
  Goal goal;
  goal.kind = form.kind;
  goal.stage = form.stage;
  goal.hold = form.hold;
  if (kind == "slap" || kind == "rest") goal.max_speed = std::numeric_limits<double>::max();
  const Element keys = element.at(kind);
  if (keys.node.IsNull() && form.needed.empty() && goal.kind != GoalKind::rest) return goal;
  for (const std::string& key : checked_keys(keys, keys_of(form))) goal_keys().at(key)(keys.at(key), goal);
  check_has(keys, form.needed);
  if (goal.kind == GoalKind::joint) check_range(keys, goal);
  if (goal.kind == GoalKind::rest) check_rest(keys, goal);
  return goal;
}

void check_order(const YamlElement& element, const std::vector<Goal>& goals) {
  for (std::size_t i = 0; i + 1 < goals.size(); ++i) {
    if (goals[i].kind == GoalKind::release) element.at(i).fail("release is not the last goal; allowed: last");
    if (goals[i].stage > goals[i + 1].stage) {
      element.at(i + 1).fail(
          std::string(to_string(goals[i + 1].kind)) + " after " + to_string(goals[i].kind) +
          "; allowed: pick, catch, nudge_into, joint, rest, tap, slap, then place, insert, then release");
    }
  }
  const auto holds = [](GoalKind kind) {
    return kind != GoalKind::nudge_into && kind != GoalKind::strike && kind != GoalKind::joint &&
           kind != GoalKind::rest;
  };
  if (goals.back().kind == GoalKind::release && (goals.size() == 1 || !holds(goals[goals.size() - 2].kind)))
    element.at(goals.size() - 1)
        .fail("release after nothing that is held; allowed: after pick, place, insert, catch");
}

}  // namespace mrhi::task_yaml
