#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>

#include "../scene/limits.h"
#include "../text/file_text.h"
#include "../text/safe_yaml.h"
#include "../text/text.h"
#include "mr_hand_interaction/scene/scene_loader.h"
#include "mr_hand_interaction/training/task.h"
#include "task_values.h"

namespace mrhi {
namespace {

using Element = YamlElement;
using namespace task_yaml;

/// "thing.urdf" beside the task's file, or a shipped scene's name.
std::string body_file(const Element& element) {
  const std::string given = string(element);
  const std::filesystem::path path(given);
  if (path.extension() != ".urdf" || path.is_absolute()) return given;
  return (std::filesystem::path(element.file).parent_path() / path).string();
}

TaskObject read_object(const Element& element) {
  TaskObject object;
  for (const std::string& key : checked_keys(element, {"name", "file", "position", "orientation", "twist"})) {
    const Element value = element.at(key);
    if (key == "name") object.name = name(value);
    if (key == "file") object.file = body_file(value);
    if (key == "position") object.start.position = read_vector(value);
    if (key == "orientation") object.start.orientation = quaternion(value);
    if (key == "twist") object.twist = twist(value);
  }
  check_has(element, {"name", "position"});
  if (object.file.empty()) object.file = object.name;
  return object;
}

Fixture read_fixture(const Element& element) {
  Fixture fixture;
  for (const std::string& key : checked_keys(element, {"name", "file", "position", "orientation"})) {
    const Element value = element.at(key);
    if (key == "name") fixture.name = name(value);
    if (key == "file") fixture.file = body_file(value);
    if (key == "position") fixture.pose.position = read_vector(value);
    if (key == "orientation") fixture.pose.orientation = quaternion(value);
  }
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
  std::vector<std::string> names;
  for (const TaskObject& object : task.objects) names.push_back(object.name);
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
      {"time_out", [](E e, Task& t) { t.time_out = number(e, kAboveZero, " [s]"); }},
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
