#pragma once

#include <mr_hand_interaction/ContactArray.h>
#include <mr_hand_interaction/ObjectStateArray.h>
#include <mr_hand_interaction/TrainingStatus.h>
#include <ros/ros.h>

#include <map>
#include <memory>
#include <vector>

#include "../training/operator_trial.h"
#include "leap_human_publisher.h"
#include "mr_hand_interaction/synthetic/synthetic_hand.h"

namespace mrhi {

/// A simulated operator does the trials of a running training_node: sees `objects` and `training/status`, and
/// its hand is on /leap_motion/leap_device, at default_device_mount(), as long as a trial runs.
/// Parameters: ~task (pick_and_place), ~group (beginner or veteran; none: undisturbed), ~seed (1), ~noise
/// (1), ~rate (115) [Hz].
class OperatorPublisher {
 public:
  /// Throws std::invalid_argument or SceneError that names what is wrong and what is allowed.
  OperatorPublisher(ros::NodeHandle node, const ros::NodeHandle& parameters);

 private:
  void take(const mr_hand_interaction::ObjectStateArray& message);
  void take_status(const mr_hand_interaction::TrainingStatus& status) { status_ = status; }
  void tick();
  bool at_work() const;
  void begin();
  void move();
  double grip() const;

  Task task_;
  OperatorSkill skill_;
  std::uint64_t seed_;
  double rate_;
  TrackingNoise noise_;
  mr_hand_interaction::TrainingStatus status_;
  mr_hand_interaction::ObjectState object_;  ///< of the trial; without a name: not seen yet
  std::map<std::string, Pose> fixed_;        ///< what no message has: devices, by name
  mr_hand_interaction::ContactArray contacts_;
  std::unique_ptr<Person> person_;
  std::uint32_t trial_ = 0;
  ros::Time ticked_;
  double time_ = 0.0;  ///< that the person has moved since the trial's begin, by the frames' stamps [s]
  std::vector<HandJoints> hands_;

  LeapHumanPublisher publisher_;
  std::vector<ros::Subscriber> subscribers_;
  ros::WallTimer timer_;
};

}  // namespace mrhi
