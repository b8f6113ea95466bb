#pragma once

#include <optional>
#include <vector>

#include "mr_hand_interaction/scene/body.h"
#include "person.h"

namespace mrhi {

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
