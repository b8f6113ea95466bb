#include <mr_hand_interaction/ContactArray.h>
#include <mr_hand_interaction/ObjectStateArray.h>
#include <mr_hand_interaction/TrainingStatus.h>
#include <ros/ros.h>

#include <algorithm>
#include <map>
#include <memory>
#include <stdexcept>
#include <vector>

#include "../ros/leap_human_publisher.h"
#include "../ros/node.h"
#include "../ros/result_messages.h"
#include "../text/text.h"
#include "../training/operator_trial.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/ros/package_paths.h"
#include "mr_hand_interaction/synthetic/synthetic_hand.h"

namespace mrhi {
namespace {

constexpr const char* kUsage =
    R"(usage: rosrun mr_hand_interaction simulated_operator_node [_PARAMETER:=VALUE]... [TOPIC:=OTHER]...

Performs the trials of a running training_node: subscribes to objects and training/status, and publishes the hand of a
simulated operator on /leap_motion/leap_device.

  ~task    NAME|FILE; default pick_and_place
  ~group   beginner, veteran or none (undisturbed); default none
  ~seed    default 1
  ~noise   factor on the noise of a Leap; default 1
  ~rate    frames per second; default 115
  ~holds_rail  whether the left hand holds a rail while the right one works afloat; default true
)";

using Status = mr_hand_interaction::TrainingStatus;

/// Longest catch-up after a late timer tick [periods].
constexpr double kMaxCatchUp = 2.0;
constexpr std::uint32_t kHands = 2;  ///< of a person: each trial has ids of its own

Body body_of(const TaskObject& object) {
  constexpr double kUsualFriction = 0.8;
  SceneOptions options;
  options.default_material.static_friction = kUsualFriction;
  const ObjectModel model = load_object(object, {}, scene_folders(), options);
  return model.scene.bodies.at(model.body);
}

/// Parameters of the node on the parameter server.
struct Parameters {
  explicit Parameters(const ros::NodeHandle& node) {
    NodeParameters known;
    known.text("group", group).number("noise", 0.0, 10.0, noise).number("rate", 1.0, 1000.0, rate);
    known.whole("seed", 0, seed).text("task", task).truth("holds_rail", holds_rail).read(node);
  }

  std::string group = "none", task = "pick_and_place";
  bool holds_rail = true;
  double noise = 1.0, rate = 115.0;  ///< [Hz]
  std::uint64_t seed = 1;
};

Task checked_task(const std::string& name) {
  Task task = load_task(find_task_file(name, task_folders()));
  OperatorStage stage;
  stage.scene_folders = scene_folders();
  check_operator(task, stage);
  return task;
}

}  // namespace

/// Sees `objects` and `training/status`. The hand is that of a Leap at default_device_mount().
class OperatorPublisher {
 public:
  /// Throws an exception with the fault and what is allowed.
  OperatorPublisher(ros::NodeHandle node, const ros::NodeHandle&, const Parameters& parameters)
      : task_(checked_task(parameters.task)),
        skill_(parameters.group == "none" ? OperatorSkill{} : draw_skill(parameters.group, parameters.seed)),
        seed_(parameters.seed),
        rate_(parameters.rate),
        noise_(parameters.noise, seed_),
        publisher_(node, rate_) {
    skill_.holds_rail = parameters.holds_rail;
    surroundings_ = load_surroundings(task_, scene_folders(), SceneOptions());
    for (const TaskObject& object : task_.objects) {
      if (const Body body = body_of(object); body.fixed) fixed_[object.name] = body.start;
    }
    const auto hints = ros::TransportHints().tcpNoDelay();
    subscribers_ = {node.subscribe("objects", 1, &OperatorPublisher::take, this, hints),
                    node.subscribe("contacts", 1, &OperatorPublisher::take_contacts, this, hints),
                    node.subscribe("training/status", 10, &OperatorPublisher::take_status, this, hints)};
    timer_ = node.createSteadyTimer(ros::WallDuration(1.0 / rate_),
                                    [this](const ros::SteadyTimerEvent&) { tick(); });
  }

 private:
  void take(const mr_hand_interaction::ObjectStateArray& message) {
    for (const auto& object : message.objects) {
      if (object.name == status_.object) object_ = object;
      if (object.is_operator) body_ = object;
    }
  }

  void take_contacts(const mr_hand_interaction::ContactArray& message) { contacts_ = message; }
  void take_status(const mr_hand_interaction::TrainingStatus& status) { status_ = status; }
  void tick() {
    const ros::Time now = ros::Time::now();
    const double since = std::clamp(seconds_between(ticked_, now), 0.0, kMaxCatchUp / rate_);
    ticked_ = now;
    if (const auto fixed = fixed_.find(status_.object); fixed != fixed_.end()) {
      object_.name = fixed->first;
      object_.pose = to_message(fixed->second);
    }
    const bool other = person_ && trial_ != status_.trial;
    const bool at_work = status_.phase == Status::RUNNING || status_.phase == Status::PAUSED;
    if (!at_work || other) {
      person_.reset();
      hands_.clear();
      object_.name.clear();
    } else if (status_.phase == Status::RUNNING && object_.name == status_.object) {
      if (person_) {
        time_ += since;
      } else {
        begin();
      }
      move();
    }
    JointsFrame frame{from_ros_time(now), hands_};
    noise_.apply(frame);
    publisher_.publish(frame);
  }

  void begin() {
    trial_ = status_.trial;
    time_ = 0.0;
    const TaskObject* const object = text::find_named(task_.objects, object_.name);
    if (object == nullptr)
      throw std::invalid_argument("task '" + task_.name + "' has no object '" + object_.name +
                                  "': training_node and the simulated operator must have the same task");
    person_ = make_person(skill_, task_, body_of(*object), seed_ + trial_, surroundings_);
  }

  void move() {
    const std::size_t goal = std::min<std::size_t>(std::max(status_.goal, 1u), task_.goals.size()) - 1;
    Sight sight =
        sight_of(task_, goal, from_message(object_.pose), from_message(object_.twist), object_.held);
    sight.grip = grip_force(contacts_, {object_.name});
    sight.body = from_message(body_.pose);
    sight.body_twist = from_message(body_.twist);
    hands_ = hands_of(*person_, time_, sight, default_device_mount());
    for (HandJoints& hand : hands_) hand.id += kHands * trial_;
  }

  Task task_;
  OperatorSkill skill_;
  std::uint64_t seed_;
  double rate_;
  TrackingNoise noise_;
  mr_hand_interaction::TrainingStatus status_;
  mr_hand_interaction::ObjectState object_;  ///< of the trial; without a name: not seen yet
  mr_hand_interaction::ObjectState body_;    ///< of the operator who floats
  Scene surroundings_;
  std::map<std::string, Pose> fixed_;  ///< devices, which no message has, by name
  mr_hand_interaction::ContactArray contacts_;
  std::unique_ptr<Person> person_;
  std::uint32_t trial_ = 0;
  ros::Time ticked_;
  double time_ = 0.0;  ///< person's time since the start of the trial, by the frames' stamps [s]
  std::vector<HandJoints> hands_;

  LeapHumanPublisher publisher_;
  std::vector<ros::Subscriber> subscribers_;
  ros::SteadyTimer timer_;
};

}  // namespace mrhi

int main(int argc, char** argv) {
  return mrhi::run_node<mrhi::OperatorPublisher, mrhi::Parameters>(argc, argv, "simulated_operator_node",
                                                                   mrhi::kUsage);
}
