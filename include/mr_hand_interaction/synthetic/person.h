#pragma once

#include <cstddef>
#include <optional>

#include "mr_hand_interaction/synthetic/scripted_motion.h"

namespace mrhi {

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

}  // namespace mrhi
