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

/// Skill of a simulated operator. docs/simulated_operators.md has the sources of the values.
struct OperatorSkill {
  double reaction_time = 0.2;     ///< from seeing to acting [s]
  double movement_start = 0.2;    ///< a of Fitts' law: duration = a + b log2(distance / width + 1) [s]
  double movement_per_bit = 0.2;  ///< b [s/bit]
  double pace = 1.0;              ///< factor of the times of closing, opening and withdrawing
  double decision_time = 0.3;     ///< from seeing that a goal is done to beginning the next [s]
  double placing_error = 0.0;     ///< of the hand relative to the object, deviation on an axis [m]
  double turning_error = 0.0;     ///< likewise about an axis [rad]
  double precision = 0.008;       ///< larger placing errors are corrected [m]
  double tremor = 0.0;            ///< of the hand, 8 to 12 Hz, rms on an axis [m]
  double least_grip = 2.5;        ///< grip force on an object without a load [N]
  double grip_margin = 1.0;       ///< relative margin of the grip force above the slip limit
  double grip_depth = 0.018;      ///< maximum depth of thumb and fingers together beyond the surface [m]
  double grip_spread = 0.0;       ///< deviation of each fingertip's fraction of the depth
  double opening = 0.018;         ///< gap between each fingertip and the object before closing [m]
  bool holds_rail = true;         ///< afloat, works with the left hand on a rail
};

OperatorSkill beginner_skill();

/// Draws one person of a group ("beginner" or "veteran"): each value of the group's with a deviation of a
/// fifth. Throws std::invalid_argument that lists the groups.
OperatorSkill draw_skill(const std::string& group, std::uint64_t seed);

/// Tremor of a hand, 8 to 12 Hz: a sum of a few waves.
class Tremor {
 public:
  /// `rms` on an axis [m].
  Tremor(double rms, Random& random);
  /// Displacement of the hand [m].
  Vector3 at(double time) const;

 private:
  struct Wave {
    double frequency, phase;
    Vector3 amplitude;
  };
  std::vector<Wave> waves_;
};

/// What a person sees and feels at one time.
struct Sight {
  Pose object;                        ///< in world
  Twist twist;                        ///< world axes
  std::optional<Vector3> place;       ///< target of the object; empty: release it
  bool held = false;                  ///< grasped, as rendered
  double precision = 1.0;             ///< of the target, if finer than the skill's [m]
  double grip = 0.0;                  ///< felt at the fingertips: half the sum of the normal forces [N]
  Vector3 gravity = Vector3::Zero();  ///< [m/s^2]
  Vector3 swing = Vector3::Zero();    ///< amplitude of an oscillation about the target, at 1 Hz [m]
  std::size_t goal = 0;               ///< index of the task's next goal
  Pose body = {};                     ///< of the operator who floats, centre of mass in world
  Twist body_twist = {};              ///< of it, world axes
  double size = 1.0;                  ///< of the object as shown, relative to its body
};

constexpr double kMaxObjectSpeed = 0.1;  ///< faster objects are not grasped [m/s]
constexpr double kCorrectionRate = 2.0;  ///< of an error that is seen [1/s]

/// Pose of an object after `seconds` at its present velocity.
Pose expected(const Pose& pose, const Twist& twist, double seconds);

/// A program in the role of a participant, which moves a hand by what it sees.
class Person {
 public:
  Person(const OperatorSkill& skill, std::uint64_t seed)
      : skill_(skill), random_(seed), tremor_(skill.tremor, random_) {}
  Person(const Person&) = delete;
  Person& operator=(const Person&) = delete;
  virtual ~Person() = default;
  /// Pose of the right hand in the tracker's frame at `time` [s], which increases from call to call.
  virtual HandPlace move(double time, const Sight& sight) = 0;
  /// The left hand at the last move(), if it takes part: its wrist's frame is mirrored as in hand_joints().
  virtual std::optional<HandPlace> left_hand() const { return std::nullopt; }

 protected:
  /// What is seen and felt at one time, with the wrist's pose and the depth of the grip.
  struct Moment {
    double time;
    Sight sight;
    Pose wrist = {};
    double depth = 0.0;
  };
  /// Stores the present moment. past_ then begins with the latest one that is a reaction time ago; false if
  /// there is none yet.
  bool remember(const Moment& now);
  double paced(double seconds) const { return skill_.pace * seconds; }

  OperatorSkill skill_;
  Random random_;
  Tremor tremor_;
  std::deque<Moment> past_;
};

/// Practised motions besides taking, carrying and releasing. `open_hatch` opens the latches first;
/// `pull_hatch` pulls the handle at once, `top_latch` and `bottom_latch` turn one latch.
enum class Skilled : std::uint8_t {
  tap,
  slap,
  catch_ball,
  nudge,
  press_button,
  open_hatch,
  pull_hatch,
  top_latch,
  bottom_latch,
  close_hatch
};

/// Motion of a skill from `open_hatch` on, at the hatch's shipped scene.
std::vector<Keyframe> hatch_motion(Skilled skill);

/// A goal and its practised motion.
struct PractisedGoal {
  Skilled skill;
  Vector3 place = Vector3::Zero();  ///< nudge: rest position of the object [m]
};

/// A program with practised motions, in the role of a person. It performs the motion of the goal at the
/// object's position a reaction time ago, with its placing error, and repeats it until the goal changes. It
/// does not correct a motion in progress. The same seed and sights give the same bits.
class PractisedPerson : public Person {
 public:
  /// One entry for each of the task's goals; empty: the hand waits. `object` has the pose of its shipped
  /// scene.
  PractisedPerson(const OperatorSkill& skill, std::vector<std::optional<PractisedGoal>> goals,
                  const Body& object, std::uint64_t seed);

  HandPlace move(double time, const Sight& sight) override;

 private:
  void look(double time, const Moment& seen);
  std::vector<Keyframe> motion(const PractisedGoal& goal, const Moment& seen, double& begin) const;
  bool ready(const PractisedGoal& goal, const Sight& sight) const;

  std::vector<std::optional<PractisedGoal>> goals_;
  Body object_;
  std::optional<Moment> looked_;  ///< a look at the object, acted on a reaction time later
  std::vector<Keyframe> keyframes_;
  double began_ = 0.0;
  HandPlace now_;
};

/// A program in the role of a person: takes an object, carries it to its target and releases it, by what it
/// saw a reaction time ago, and corrects a movement to the object by what it saw 0.1 s ago. It fits its
/// fingers to the size that it saw a reaction time ago. Its grip follows the force felt shortly before and
/// the expected load. A right hand; the same seed and sights give the same bits.
class SimulatedOperator : public Person {
 public:
  enum class Phase : std::uint8_t { watching, reaching, grasping, carrying, releasing, withdrawing, done };

  /// Grasps the object by grasp_of(). Throws as that does.
  SimulatedOperator(const OperatorSkill& skill, const Body& object, std::uint64_t seed);

  HandPlace move(double time, const Sight& sight) override;

  Phase phase() const { return phase_; }

 private:
  void decide(double time, const Moment& seen);
  void watch(double time, const Moment& seen);
  void reach(double time, const Moment& seen);
  void grasp(double time, const Moment& seen);
  void carry(const Moment& seen);
  void follow_up(double time, const Moment& seen);
  void release();
  void shake_off();
  void withdraw();
  void prepare_grasp(double size);
  void fit_to(double size);
  void replan_fingers(double size);
  void correct(double since, const Moment& seen);
  void control_grip(double time, double since);
  const Moment& before(double time, double delay) const;
  HandPlace planned(double time) const;
  Vector3 oscillation(double time) const;
  Vector3 acceleration(double time) const;
  Pose wrist_about(const Pose& object);
  void plan(Phase phase, const Moment& seen, const Vector3& drift = Vector3::Zero());
  void close_to(double depth, double duration);
  bool arrived(double time) const {
    return time >= began_ + (fingers_.empty() ? keyframes_ : fingers_).back().time;
  }
  bool is_astray(const Moment& seen) const;
  double distance_from_grip(const Moment& seen) const;
  double movement_time(double distance, double width) const;

  Grasp usual_;                         ///< of the object in its shipped scene
  std::vector<Quaternion> symmetries_;  ///< of the object
  double mass_, friction_;
  double firmness_ = 1.0;  ///< grip factor, increased after a loss

  Grasp grasp_;        ///< of the next or present take, for an object of size 1
  double size_ = 1.0;  ///< of the object, for which the postures are
  std::optional<GripPostures> postures_;
  std::optional<double> grip_began_;          ///< time since which force leads the fingers [s]
  double depth_ = 0.0, target_force_ = 0.0;   ///< of the grip: present depth [m]; target [N]
  double stiffness_;                          ///< learned stiffness of the grip [N/m]
  Pose grasp_error_;                          ///< error of the grasp, in the object's frame
  Vector3 error_in_world_ = Vector3::Zero();  ///< its displacement, in world
  Vector3 seen_in_wrist_ = Vector3::Zero();   ///< position of the object in the wrist's frame, as seen
  Vector3 retreat_ = Vector3::UnitZ();        ///< in world
  Vector3 in_hand_ = Vector3::Zero();         ///< wanted position of the object in the wrist's frame

  Phase phase_ = Phase::watching;
  double began_ = 0.0;  ///< start of the movement [s]
  std::vector<Keyframe> keyframes_;
  std::vector<Keyframe> fingers_;        ///< postures alone, where their times differ from the wrist's
  Vector3 drift_ = Vector3::Zero();      ///< of the whole path, with a drifting object [m/s]
  Vector3 bow_ = Vector3::Zero();        ///< of the path to the object, which ends when the hand leaves it
  Vector3 corrected_ = Vector3::Zero();  ///< of the path so far [m]
  std::optional<double> swing_began_;
  Vector3 swing_ = Vector3::Zero();
  Moment aim_{};  ///< by which the path was planned
  HandPlace now_;
  Vector3 velocity_ = Vector3::Zero();      ///< of the wrist
  HandPosture rate_ = HandPosture::Zero();  ///< of the posture [rad/s]
  double last_time_ = 0.0;
};

}  // namespace mrhi
