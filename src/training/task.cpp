#include "mr_hand_interaction/training/task.h"

#include <algorithm>
#include <cmath>

#include "../text/text.h"

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

}  // namespace mrhi
