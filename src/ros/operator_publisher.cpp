#include "operator_publisher.h"

#include <algorithm>
#include <stdexcept>

#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/ros/package_paths.h"
#include "node.h"

namespace mrhi {
namespace {

using Status = mr_hand_interaction::TrainingStatus;

/// A person whom the machine has kept waiting goes on from where he was [periods].
constexpr double kLongestMove = 2.0;

std::string text_from(const ros::NodeHandle& parameters, const char* name, const std::string& otherwise) {
  std::string text = otherwise;
  read_parameter(parameters, name, "a string", text);
  return text;
}

double number_from(const ros::NodeHandle& parameters, const char* name, double otherwise, double lowest) {
  double value = otherwise;
  read_parameter(parameters, name, "a number", value);
  if (value >= lowest) return value;
  throw std::invalid_argument("parameter " + parameters.resolveName(name) + " must be at least " +
                              std::to_string(lowest));
}

Body body_of(const TaskObject& object) {
  constexpr double kUsualFriction = 0.8;
  SceneOptions options;
  options.default_material.static_friction = kUsualFriction;
  const Scene scene = load_scene(find_scene_file(object.file, scene_folders()), options);
  Body body = scene.bodies.at(find_body(scene, object.name).value_or(0));
  body.start = object.start;
  return body;
}

Task task_from(const ros::NodeHandle& parameters) {
  refuse_unknown(parameters, {"group", "noise", "rate", "seed", "task"});
  Task task = load_task(find_task_file(text_from(parameters, "task", "pick_and_place"), task_folders()));
  for (const TaskObject& object : task.objects) make_person({}, task, body_of(object), 0);  // or says why not
  return task;
}

OperatorSkill skill_from(const ros::NodeHandle& parameters, std::uint64_t seed) {
  const std::string group = text_from(parameters, "group", "none");
  return group == "none" ? OperatorSkill{} : draw_skill(group, seed);
}

}  // namespace

OperatorPublisher::OperatorPublisher(ros::NodeHandle node, const ros::NodeHandle& parameters)
    : task_(task_from(parameters)),
      seed_(read_seed(parameters, 1)),
      rate_(number_from(parameters, "rate", 115.0, 1.0)),
      noise_(number_from(parameters, "noise", 1.0, 0.0), seed_),
      publisher_(node, rate_) {
  skill_ = skill_from(parameters, seed_);
  for (const TaskObject& object : task_.objects) {
    if (const Body body = body_of(object); body.fixed) fixed_[object.name] = body.start;
  }
  const auto hints = ros::TransportHints().tcpNoDelay();
  subscribers_ = {
      node.subscribe("objects", 1, &OperatorPublisher::take, this, hints),
      node.subscribe<mr_hand_interaction::ContactArray>(
          "contacts", 1,
          [this](const mr_hand_interaction::ContactArray::ConstPtr& message) { contacts_ = *message; },
          nullptr, hints),
      node.subscribe("training/status", 10, &OperatorPublisher::take_status, this, hints)};
  timer_ =
      node.createWallTimer(ros::WallDuration(1.0 / rate_), [this](const ros::WallTimerEvent&) { tick(); });
}

void OperatorPublisher::take(const mr_hand_interaction::ObjectStateArray& message) {
  for (const auto& object : message.objects) {
    if (object.name == status_.object) object_ = object;
  }
}

bool OperatorPublisher::at_work() const {
  return status_.phase == Status::RUNNING || status_.phase == Status::PAUSED;
}

void OperatorPublisher::tick() {
  const ros::Time now = ros::Time::now();
  const double since = std::clamp(seconds_between(ticked_, now), 0.0, kLongestMove / rate_);
  ticked_ = now;
  if (const auto fixed = fixed_.find(status_.object); fixed != fixed_.end()) {
    object_.name = fixed->first;
    object_.pose = to_message(fixed->second);
  }
  const bool other = person_ && trial_ != status_.trial;
  if (!at_work() || other) {
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

void OperatorPublisher::begin() {
  trial_ = status_.trial;
  time_ = 0.0;
  const auto named = [this](const TaskObject& object) { return object.name == object_.name; };
  const auto object = std::find_if(task_.objects.begin(), task_.objects.end(), named);
  if (object == task_.objects.end())
    throw std::invalid_argument("task '" + task_.name + "' has no object '" + object_.name +
                                "': training_node and the simulated operator must have the same task");
  person_ = make_person(skill_, task_, body_of(*object), seed_ + trial_);
}

void OperatorPublisher::move() {
  const std::size_t goal = std::min<std::size_t>(std::max(status_.goal, 1u), task_.goals.size()) - 1;
  const Twist twist{from_message(object_.twist.linear), from_message(object_.twist.angular)};
  Sight sight = sight_of(task_, goal, from_message(object_.pose), twist, object_.held);
  sight.grip = grip();
  const HandPlace hand = person_->move(time_, sight);
  hands_ = {
      hand_joints(human_hand(), Side::right, default_device_mount().inverse() * hand.wrist, hand.posture)};
  hands_.front().id = trial_;
}

/// As observe() has it.
double OperatorPublisher::grip() const {
  double pressing = 0.0;
  for (const auto& contact : contacts_.contacts) {
    if (contact.object == object_.name)
      pressing += std::max(0.0, -from_message(contact.normal).dot(from_message(contact.force)));
  }
  return 0.5 * pressing;
}

}  // namespace mrhi
