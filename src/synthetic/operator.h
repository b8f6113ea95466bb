#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "mr_hand_interaction/scene/body.h"
#include "mr_hand_interaction/synthetic/random.h"
#include "person.h"
#include "scripted_grasp.h"

namespace mrhi {

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
