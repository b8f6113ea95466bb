#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "motions.h"
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

/// A program in a person's place: takes an object, carries it where it is wanted and lets it go, by what it
/// saw a reaction time ago; grips by the force it felt a moment ago and by the load it expects. A right hand;
/// the same seed and sights give the same bits.
class SimulatedOperator : public Person {
 public:
  enum class Phase : std::uint8_t { watching, reaching, grasping, carrying, letting_go, withdrawing, done };

  /// Grasps the object as grasp_of() says, and throws as it does.
  SimulatedOperator(const OperatorSkill& skill, const Body& object, std::uint64_t seed);

  HandPlace move(double time, const Sight& sight) override;

  Phase phase() const { return phase_; }

 private:
  struct Moment {
    double time;
    Sight sight;
    Pose wrist;
    double depth;
  };
  void decide(double time, const Moment& seen);
  void watch(double time, const Moment& seen);
  void reach(double time, const Moment& seen);
  void grasp(double time, const Moment& seen);
  void carry(const Moment& seen);
  void follow_up(double time, const Moment& seen);
  void let_go();
  void shake_off();
  void lose();
  void prepare_grasp();
  void correct(double since, const Moment& seen);
  void squeeze(double time, double since);
  const Moment& felt(double time) const;
  HandPlace planned(double time) const;
  Vector3 swung(double time) const;
  Vector3 acceleration(double time) const;
  Pose wrist_about(const Pose& object);
  void plan(Phase phase, const Moment& seen, const Vector3& drift = Vector3::Zero());
  void then(double duration, const Pose& wrist, const HandPosture& posture);
  void close_to(double depth, double duration);
  bool arrived(double time) const { return time >= began_ + way_.back().time; }
  bool is_astray(const Moment& seen) const;
  double distance_from_grip(const Moment& seen) const;
  double movement_time(double distance, double width) const;

  OperatorSkill skill_;
  Grasp usual_;                    ///< of the object as it lies in its shipped scene
  std::vector<Quaternion> turns_;  ///< that leave the object looking as it did
  Random random_;
  Tremor tremor_;
  double mass_, friction_;
  double firmness_ = 1.0;  ///< grips harder after a loss

  std::optional<GripPostures> postures_;
  std::optional<double> gripping_;      ///< since when the force is what leads the fingers [s]
  double depth_ = 0.0, wanted_ = 0.0;   ///< of the squeeze [m], [N]
  double stiffness_;                    ///< that it has found the grip to have [N/m]
  Pose misplaced_;                      ///< the grasp against where it should be, in the object's frame
  Vector3 beside_ = Vector3::Zero();    ///< by so much, in world
  Vector3 middle_ = Vector3::Zero();    ///< where the object is to be in the wrist's frame as far as it sees
  Vector3 retreat_ = Vector3::UnitZ();  ///< in world
  Vector3 in_hand_ = Vector3::Zero();   ///< where the object is to be in the wrist's frame

  Phase phase_ = Phase::watching;
  std::deque<Moment> past_;  ///< as long as the reaction time
  double began_ = 0.0;       ///< the way [s]
  std::vector<Keyframe> way_;
  std::vector<Keyframe> fingers_;        ///< postures alone, where they keep other times than the wrist
  Vector3 drift_ = Vector3::Zero();      ///< of all the way, with an object that drifts [m/s]
  Vector3 bow_ = Vector3::Zero();        ///< of the way to the object, which ends as the hand leaves it
  Vector3 corrected_ = Vector3::Zero();  ///< of the way so far [m]
  std::optional<double> swing_began_;
  Vector3 swing_ = Vector3::Zero();
  Moment aim_{};  ///< that the way was planned by
  HandPlace now_;
  Vector3 velocity_ = Vector3::Zero();  ///< of the wrist
  double last_time_ = 0.0;
};

}  // namespace mrhi
