#include "mr_hand_interaction/training/task.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>

#include "../math/rotation.h"
#include "../scene/limits.h"
#include "../text/files.h"
#include "../text/text.h"
#include "../text/yaml.h"
#include "mr_hand_interaction/scene/scene_loader.h"

namespace mrhi {

const char* to_string(TrainingStage stage) {
  static const char* const names[] = {"manipulation", "maintenance", "release"};
  return names[static_cast<std::size_t>(stage)];
}

const char* to_string(GoalKind kind) {
  static const char* const names[] = {"pick",   "place", "insert", "catch",  "nudge_into",
                                      "strike", "joint", "rest",   "release"};
  return names[static_cast<std::size_t>(kind)];
}

std::size_t Task::places() const {
  return static_cast<std::size_t>(std::count_if(
      goals.begin(), goals.end(), [](const Goal& goal) { return goal.stage == TrainingStage::maintenance; }));
}

std::size_t Task::place_number(std::size_t goal) const {
  if (goals[goal].stage != TrainingStage::maintenance) return 0;
  std::size_t number = 0;
  for (std::size_t i = 0; i <= goal; ++i) number += goals[i].stage == TrainingStage::maintenance;
  return number;
}

std::string instruction(const Task& task, std::size_t index, const std::string& object) {
  const Goal& goal = task.goals[index];
  if (!goal.instruction.empty()) return goal.instruction;
  const std::string thing = "the " + text::with_spaces(object), seconds = text::number(goal.hold) + " s";
  switch (goal.kind) {
    case GoalKind::pick:
      return "Pick up " + thing;
    case GoalKind::place:
      return "Hold " + thing + " at place " + std::to_string(task.place_number(index)) + " of " +
             std::to_string(task.places()) + " for " + seconds;
    case GoalKind::insert:
      return "Put " + thing + " into the place and hold it there for " + seconds;
    case GoalKind::catch_it:
      return "Catch " + thing + " and hold it for " + seconds;
    case GoalKind::nudge_into:
      return "Nudge " + thing + " into the box, without grasping it";
    case GoalKind::strike:
      return "Strike " + thing + ": it is to leave your hand at " + text::number(goal.min_speed) + " to " +
             text::number(goal.max_speed) + " m/s";
    case GoalKind::joint:
      return "Work the " + text::with_spaces(goal.joint);
    case GoalKind::rest:
      if (!goal.of_operator) return "Bring " + thing + " to rest at its place";
      return std::isfinite(goal.tolerance) ? "Move yourself to " + thing + " and stop there"
                                           : "Stop your own motion";
    case GoalKind::release:
      break;
  }
  return "Let go of " + thing + " and leave it";
}

// A task's file. What reads a value throws InputError for what is not allowed.
namespace {

using Element = YamlElement;

constexpr Range kAboveZero{0.0, 1e6, false}, kFromZero{0.0, 1e6};

std::string string(const Element& element) {
  if (!element.node.IsScalar() || element.node.Scalar().empty()) element.refuse("a text");
  return text::one_line(element.node.Scalar(), 500);
}

std::string choice(const Element& element, const std::string& one, const std::string& other) {
  const std::string value = string(element);
  if (value != one && value != other) element.refuse(one + " or " + other);
  return value;
}

/// See is_name().
std::string name(const Element& element) {
  const std::string value = string(element);
  if (!is_name(value)) element.refuse(std::string("a name of ") + kNameIs);
  return value;
}

Vector3 unit_vector(const Element& element) {
  const Vector3 value = read_vector(element);
  if (value.norm() < 1e-6) element.refuse("a direction [x, y, z]");
  return value.normalized();
}

Quaternion quaternion(const Element& element) {
  constexpr double kLengthTolerance = 0.01;
  const char* const allowed = "a unit quaternion [x, y, z, w]";
  const auto value = yaml_numbers(element.node, 4);
  if (!value) element.refuse(allowed);
  const Eigen::Vector4d numbers(value->data());
  if (std::abs(numbers.norm() - 1.0) > kLengthTolerance) element.refuse(allowed);
  return Quaternion(numbers.normalized());
}

void check_has(const Element& element, const std::vector<std::string>& needed) {
  for (const std::string& key : needed) {
    if (!element.node[key]) element.fail("no key '" + key + "'; needed: " + text::joined(needed));
  }
}

constexpr Range kJointPlace{-1e3, 1e3};

void speed_range(const Element& element, Goal& goal) {
  const auto value = yaml_numbers(element.node, 2);
  if (!value || value->front() < 0.0 || value->front() >= value->back() ||
      !kAboveZero.contains(value->back()))
    element.refuse("[slowest, fastest] in m/s, slowest at least 0 and below fastest");
  goal.min_speed = value->front();
  goal.max_speed = value->back();
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
      {"tolerance", [](E e, Goal& g) { g.tolerance = read_number(e, kAboveZero, " [m]"); }},
      {"angle_tolerance",
       [](E e, Goal& g) {
         g.angle_tolerance = kDegree * read_number(e, {0.0, 180.0, false}, " [degrees]");
       }},
      {"axis", [](E e, Goal& g) { g.axis = unit_vector(e); }},
      {"size", [](E e, Goal& g) { g.size = box_size(e); }},
      {"hold", [](E e, Goal& g) { g.hold = read_number(e, kFromZero, " [s]"); }},
      {"leaving",
       [](E e, Goal& g) {
         g.leaving = choice(e, "reset", "stop") == "stop" ? Leaving::stop : Leaving::reset;
       }},
      {"distance", [](E e, Goal& g) { g.distance = read_number(e, kFromZero, " [m]"); }},
      {"within", [](E e, Goal& g) { g.within = read_number(e, kAboveZero, " [s]"); }},
      {"name", [](E e, Goal& g) { g.joint = name(e); }},
      {"above", [](E e, Goal& g) { g.above = read_number(e, kJointPlace, " [rad], [m]"); }},
      {"below", [](E e, Goal& g) { g.below = read_number(e, kJointPlace, " [rad], [m]"); }},
      {"max_speed", [](E e, Goal& g) { g.max_speed = read_number(e, kAboveZero, " [m/s]"); }},
      {"min_speed", [](E e, Goal& g) { g.min_speed = read_number(e, kAboveZero, " [m/s]"); }},
      {"speed", [](E e, Goal& g) { speed_range(e, g); }},
      {"max_spin", [](E e, Goal& g) { g.max_spin = read_number(e, kAboveZero, " [rad/s]"); }},
      {"body", [](E e, Goal& g) { g.of_operator = choice(e, "object", "operator") == "operator"; }},
      {"drift_time", [](E e, Goal& g) { g.drift_time = read_number(e, kFromZero, " [s]"); }},
  };
  return keys;
}

/// YAML form of a goal.
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

/// One entry of a task's `goals`.
Goal read_goal(const Element& element) {
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

/// Stages in their order, release last and after something that is held.
void check_order(const Element& element, const std::vector<Goal>& goals) {
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

/// "thing.urdf" beside the task's file, or a shipped scene's name.
std::string body_file(const Element& element) {
  const std::string value = string(element);
  const std::filesystem::path path(value);
  if (path.extension() != ".urdf" || path.is_absolute()) return value;
  return (std::filesystem::path(element.file).parent_path() / path).string();
}

TaskObject read_placed(const Element& element, const std::vector<std::string>& known) {
  TaskObject object;
  for (const std::string& key : checked_keys(element, known)) {
    const Element value = element.at(key);
    if (key == "name") object.name = name(value);
    if (key == "file") object.file = body_file(value);
    if (key == "position") object.start.position = read_vector(value);
    if (key == "orientation") object.start.orientation = quaternion(value);
    if (key == "twist") object.twist = read_twist(value);
  }
  return object;
}

TaskObject read_object(const Element& element) {
  TaskObject object = read_placed(element, {"name", "file", "position", "orientation", "twist"});
  check_has(element, {"name", "position"});
  if (object.file.empty()) object.file = object.name;
  return object;
}

TaskObject read_fixture(const Element& element) {
  const TaskObject fixture = read_placed(element, {"name", "file", "position", "orientation"});
  check_has(element, {"name", "file", "position"});
  return fixture;
}

template <class Item>
std::vector<Item> read_list(const Element& element, Item (*read)(const Element&)) {
  if (!element.node.IsSequence() || element.node.size() == 0) element.refuse("a list of at least one");
  std::vector<Item> items;
  for (std::size_t i = 0; i < element.node.size(); ++i) items.push_back(read(element.at(i)));
  return items;
}

void check_names(const Element& root, const Task& task) {
  std::vector<std::string> names = text::names_of(task.objects);
  for (const Fixture& fixture : task.fixtures) names.push_back(fixture.name);
  std::sort(names.begin(), names.end());
  const auto twice = std::adjacent_find(names.begin(), names.end());
  if (twice != names.end()) root.fail("objects: '" + *twice + "' is there twice; allowed: each name once");
}

void check_operator_is_there(const Element& root, const Task& task) {
  for (const Goal& goal : task.goals) {
    if (goal.of_operator && task.scene.empty())
      root.fail(
          "goals: rest of the operator, and no key 'scene'; allowed: 'scene' with a scene that has an "
          "operator");
  }
}

int repetitions(const Element& element) {
  const std::optional<int> count = yaml_integer(element.node);
  if (!count || *count < 1 || *count > 1000) element.refuse("a whole number from 1 to 1000");
  return *count;
}

const std::map<std::string, std::function<void(const Element&, Task&)>>& task_keys() {
  using E = const Element&;
  static const std::map<std::string, std::function<void(const Element&, Task&)>> keys{
      {"name", [](E e, Task& t) { t.name = name(e); }},
      {"instructions", [](E e, Task& t) { t.instructions = string(e); }},
      {"gravity", [](E e, Task& t) { t.gravity = read_vector(e, body_limits::kGravity); }},
      {"objects", [](E e, Task& t) { t.objects = read_list(e, read_object); }},
      {"fixtures", [](E e, Task& t) { t.fixtures = read_list(e, read_fixture); }},
      {"scene", [](E e, Task& t) { t.scene = body_file(e); }},
      {"order",
       [](E e, Task& t) { t.latin_square = choice(e, "latin_square", "as_listed") == "latin_square"; }},
      {"practice", [](E e, Task& t) { t.practice = choice(e, "true", "false") == "true"; }},
      {"repetitions", [](E e, Task& t) { t.repetitions = repetitions(e); }},
      {"time_out", [](E e, Task& t) { t.time_out = read_number(e, kAboveZero, " [s]"); }},
      {"goals", [](E e, Task& t) { t.goals = read_list(e, read_goal), check_order(e, t.goals); }},
  };
  return keys;
}

}  // namespace

std::string find_task_file(const std::string& task, const std::vector<std::string>& directories) {
  return find_named_file("task", task, ".yaml", directories);
}

Task load_task(const std::string& file) {
  Task task;
  read_yaml<SceneError>(file, [&] {
    const Element root{file, "", load_yaml_file(file)};
    std::vector<std::string> known;
    for (const auto& key : task_keys()) known.push_back(key.first);
    for (const std::string& key : checked_keys(root, known)) task_keys().at(key)(root.at(key), task);
    for (const std::string key : {"name", "objects", "goals"}) {
      if (!root.node[key]) throw SceneError(file + ": no key '" + key + "'; needed: name, objects, goals");
    }
    check_names(root, task);
    check_operator_is_there(root, task);
  });
  return task;
}

}  // namespace mrhi
