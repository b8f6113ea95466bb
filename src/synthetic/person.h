#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/scene/body.h"
#include "mr_hand_interaction/synthetic/random.h"
#include "mr_hand_interaction/synthetic/scripted_motion.h"

namespace mrhi {

/// How well a simulated operator does things. docs/simulated_operators.md says where the figures come from.
struct OperatorSkill {
  double reaction_time = 0.2;     ///< until what is seen is acted on [s]
  double movement_start = 0.2;    ///< a of Fitts' law: duration = a + b log2(distance / width + 1) [s]
  double movement_per_bit = 0.2;  ///< b [s/bit]
  double pace = 1.0;              ///< factor on how long closing, opening and withdrawing take
  double decision_time = 0.3;     ///< between seeing that one thing is done and beginning the next [s]
  double placing_error = 0.0;     ///< of the hand about the object, deviation on an axis [m]
  double turning_error = 0.0;     ///< likewise about an axis [rad]
  double precision = 0.008;       ///< a place missed by more than this is corrected [m]
  double tremor = 0.0;            ///< of the hand, 8 to 12 Hz, rms on an axis [m]
  double least_grip = 2.5;        ///< that it holds with what has no load [N]
  double grip_margin = 1.0;       ///< of the grip beyond that, above what the load needs in order not to slip
  double grip_depth = 0.018;      ///< thumb and fingers together close no farther beyond the surface [m]
  double grip_spread = 0.0;       ///< deviation of each tip's share of the depth
  double opening = 0.018;         ///< gap between each tip and the object before closing [m]
};

OperatorSkill beginner_skill();
OperatorSkill veteran_skill();

/// One person of the group ("beginner" or "veteran"): each figure of the group's with a deviation of a fifth.
/// Throws std::invalid_argument that lists the groups.
OperatorSkill draw_skill(const std::string& group, std::uint64_t seed);

/// A hand's, 8 to 12 Hz: a sum of a few waves.
class Tremor {
 public:
  /// `rms` on an axis [m].
  Tremor(double rms, Random& random);
  /// What it moves the hand by [m].
  Vector3 at(double time) const;

 private:
  struct Wave {
    double frequency, phase;
    Vector3 amplitude;
  };
  std::vector<Wave> waves_;
};

/// What there is to see, and to feel, at one time.
struct Sight {
  Pose object;                        ///< in world
  Twist twist;                        ///< world axes
  std::optional<Vector3> place;       ///< where the object is wanted; nothing: it is to be let go
  bool held = false;                  ///< the system shows it as grasped
  double precision = 1.0;             ///< that the place asks for, if it is more than the skill's [m]
  double grip = 0.0;                  ///< that the fingertips feel: half the sum of what presses on it [N]
  Vector3 gravity = Vector3::Zero();  ///< [m/s^2]
  Vector3 swing = Vector3::Zero();    ///< at the place the object is to go to and fro by so much at 1 Hz [m]
  std::size_t goal = 0;               ///< of the task, that is to be reached next
};

/// Who moves a hand by what is seen: a program in a participant's place.
class Person {
 public:
  Person() = default;
  Person(const Person&) = delete;
  Person& operator=(const Person&) = delete;
  virtual ~Person() = default;
  /// The right hand in world at `time` [s], which increases from call to call.
  virtual HandPlace move(double time, const Sight& sight) = 0;
};

/// What a practised person can do besides to take, carry and let go.
/// `open_hatch` undoes the latches first, `pull_hatch` takes the handle at once.
enum class Skilled : std::uint8_t {
  tap,
  slap,
  catch_ball,
  nudge,
  press_button,
  open_hatch,
  pull_hatch,
  close_hatch
};

/// One thing to be done.
struct PractisedGoal {
  Skilled skill;
  Vector3 place = Vector3::Zero();  ///< nudge: where the object is to come to rest [m]
};

/// A program in a person's place that has practised motions: makes the one that the goal asks for where it
/// saw the object a reaction time ago, missing by its placing error, and again until the goal is another one.
/// It does not correct a motion once it is on the way. The same seed and sights give the same bits.
class PractisedPerson : public Person {
 public:
  /// A goal for each of the task's; nothing: the hand waits. `object` lies as in its shipped scene.
  PractisedPerson(const OperatorSkill& skill, std::vector<std::optional<PractisedGoal>> goals,
                  const Body& object, std::uint64_t seed);

  HandPlace move(double time, const Sight& sight) override;

 private:
  struct Moment {
    double time;
    Sight sight;
  };
  void look(double time, const Moment& seen);
  std::vector<Keyframe> motion(const PractisedGoal& goal, const Moment& seen, double& begin) const;
  bool ready(const PractisedGoal& goal, const Sight& sight) const;

  OperatorSkill skill_;
  std::vector<std::optional<PractisedGoal>> goals_;
  Body object_;
  Random random_;
  Tremor tremor_;
  std::optional<Moment> looked_;  ///< at the object, to be acted on a reaction time later
  std::vector<Keyframe> way_;
  double began_ = 0.0;
  HandPlace now_;
};

}  // namespace mrhi
