#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "mr_hand_interaction/training/session.h"
#include "mr_hand_interaction/training/trial.h"

namespace mrhi::test {

inline Task shipped_task(const std::string& name) {
  return load_task("config/tasks/" + name + ".yaml");
}

/// Of a participant whom nothing distinguishes.
inline SessionHeader header() {
  SessionHeader header;
  header.participant = "P01";
  header.group = "beginner";
  header.handedness = "right";
  header.condition = "implicit";
  header.started = "2024-05-06T10:00:00Z";
  header.software = "0.1.0";
  return header;
}

inline Goal pick() {
  return {};
}

inline Goal place(const Vector3& position, Leaving leaving = Leaving::reset) {
  Goal goal;
  goal.kind = GoalKind::place;
  goal.stage = TrainingStage::maintenance;
  goal.position = position;
  goal.hold = 3.0;
  goal.leaving = leaving;
  return goal;
}

inline Goal release() {
  Goal goal;
  goal.kind = GoalKind::release;
  goal.stage = TrainingStage::release;
  return goal;
}

const Vector3 kFirst(0.1, 0.0, 0.2), kSecond(0.2, 0.0, 0.2), kAway(0.0, 0.3, 0.2);

/// One cube, two places.
inline Task two_places() {
  Task task;
  task.name = "two_places";
  task.objects = {{"cube", "cube", {}, {}}};
  task.goals = {pick(), place(kFirst), place(kSecond), release()};
  return task;
}

/// Feeds a trial at 100 Hz.
class Feeder {
 public:
  explicit Feeder(const Task& task) : trial(task) {}

  /// One observation, 10 ms after the one before.
  void step() {
    seen.stamp += 10'000'000;
    trial.update(seen);
    events.insert(events.end(), trial.events().begin(), trial.events().end());
  }
  Feeder& stay(double seconds) {
    for (int i = 0; i < static_cast<int>(100 * seconds + 0.5); ++i) step();
    return *this;
  }
  Feeder& at(const Vector3& position) {
    seen.pose.position = position;
    step();
    return *this;
  }
  Feeder& held(bool is_held) {
    seen.held = is_held;
    step();
    return *this;
  }
  int count(TrialEventKind kind) const {
    int n = 0;
    for (const TrialEvent& event : events) n += event.kind == kind;
    return n;
  }

  Trial trial;
  Observation seen;
  std::vector<TrialEvent> events;
};

constexpr double kFrame = 0.0101;  // one observation more or less [s]

}  // namespace mrhi::test
