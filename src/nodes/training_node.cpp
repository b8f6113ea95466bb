#include <mr_hand_interaction/ContactArray.h>
#include <mr_hand_interaction/HandFrame.h>
#include <mr_hand_interaction/InteractionEvent.h>
#include <mr_hand_interaction/ObjectStateArray.h>
#include <mr_hand_interaction/TrainingEvent.h>
#include <mr_hand_interaction/TrainingStatus.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>
#include <visualization_msgs/MarkerArray.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "../ros/marker_layers.h"
#include "../ros/node.h"
#include "../ros/result_messages.h"
#include "../ros/training_system.h"
#include "../text/text.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/training/session.h"

namespace mrhi {
namespace {

namespace msg = mr_hand_interaction;

constexpr const char* kUsage =
    R"(usage: rosrun mr_hand_interaction training_node _participant:=NAME _folder:=FOLDER _group:=NAME _handedness:=SIDE
              _condition:=NAME [_PARAMETER:=VALUE]...

Guides a participant through a task beside a running interaction_node and logs the session. training.launch starts
all nodes that it needs. Publishes training/status and training/markers. Services: ~next, ~pause, ~skip, ~repeat.

  ~participant, ~folder        the participant and the session's folder; these five are required
  ~group, ~handedness, ~condition
                               such as beginner; right or left; what is compared, such as implicit
  ~task                        NAME|FILE; default pick_and_place
  ~auto_next                   pause between trials, at most 3600 s; negative: each trial waits for ~next; default 3
  ~seed, ~number, ~session, ~simulated, ~simulation, ~auto_start, ~operator
                               see docs/training.md
)";

constexpr int kQueue = 100;
constexpr double kMaxContactAge = 0.1;    // [s]
constexpr double kStartTolerance = 0.02;  // distance from its start at which an object is placed [m, rad]
constexpr double kStartDelay = 0.5;       // time for which it may have moved before it is first seen [s]
constexpr Nanoseconds kMinClockOffset = 1'000'000'000;  // more than any delay of a message
const ros::WallDuration kPeriod(1.0 / 20), kRetry(2.0);

Nanoseconds now() {
  return from_ros_time(ros::Time::now());
}

}  // namespace

/// Runs a session with the objects of an interaction_node, and shows its progress. One thread.
class TrainingServer {
 public:
  TrainingServer(ros::NodeHandle node, ros::NodeHandle private_node, const TrainingParameters& parameters)
      : event_(node.advertise<msg::TrainingEvent>("training/events", kQueue)),
        session_(parameters.open_session(node, now(), [this](const EventRow& row) { publish(row); })),
        scene_(parameters.simulation, session_.task()),
        parameters_(parameters.expected_configuration(node, session_.task().gravity)),
        participant_(parameters.header.participant),
        auto_next_(parameters.auto_next) {
    for (const std::string& note : session_.folder().notes()) ROS_WARN("%s", note.c_str());
    if (parameters.auto_start) next_ = ros::SteadyTime::now();
    status_ = node.advertise<msg::TrainingStatus>("training/status", kQueue, true);
    markers_ = node.advertise<visualization_msgs::MarkerArray>("training/markers", 10);
    advertise_services(private_node);
    const auto hints = ros::TransportHints().tcpNoDelay();
    subscribers_ = {
        node.subscribe("objects", kQueue, &TrainingServer::take, this, hints),
        node.subscribe("interaction_events", kQueue, &TrainingServer::take_event, this, hints),
        node.subscribe("simulation_input", kQueue, &TrainingServer::take_input, this, hints),
        node.subscribe("contacts", kQueue, &TrainingServer::take_contacts, this, hints),
        node.subscribe("joint_states", kQueue, &TrainingServer::take_joints, this, hints),
        node.subscribe("hand_frame", kQueue, &TrainingServer::take_hands, this, hints),
        node.subscribe("tracked_hands", kQueue, &TrainingServer::take_filtered_hands, this, hints)};
    timer_ = node.createSteadyTimer(kPeriod, [this](const ros::SteadyTimerEvent&) { tick(); });
  }

  ~TrainingServer() {
    try {
      session_.abort(now());
    } catch (const std::exception& error) {
      if (std::uncaught_exceptions() == 0) ROS_ERROR("%s", error.what());  // else that exception is reported
    }
  }

 private:
  void advertise_services(ros::NodeHandle& node) {
    serve<std_srvs::Trigger>(node, "skip", [this](const auto&) { return skip(); });
    serve<std_srvs::Trigger>(node, "repeat", [this](const auto&) { return repeat(); });
    serve<std_srvs::Trigger>(node, "next", [this](const auto&) { return next(); });
    serve<std_srvs::SetBool>(node, "pause", [this](const auto& request) { return pause(request.data); });
  }

  /// `action` returns an error, or an empty string. roscpp continues after an exception in a service; a
  /// session that cannot be written must end the node.
  template <class Service, class Action>
  void serve(ros::NodeHandle& node, const char* name, const Action& action) {
    services_.push_back(mrhi::serve<Service>(node, name, [this, action](const auto& request, auto& response) {
      std::string error = failed_;
      try {
        session_.folder().check_there();
        if (error.empty()) error = action(request);
      } catch (const SessionError& problem) {
        error = failed_ = problem.what();
      }
      response.success = error.empty();
      response.message = error;
      publish();
    }));
  }

  void take(const msg::ObjectStateArray& message) {
    std::set<std::string> names;
    since_.person.reset();
    for (const auto& object : message.objects) {
      if (!object.is_operator) names.insert(object.name);
      if (object.is_operator && !since_.person)
        since_.person = OperatorMotion{from_message(object.pose), from_message(object.twist)};
    }
    scene_.note_objects(std::move(names), since_.person.has_value());
    fixed_frame_ = message.header.frame_id;
    const auto* const object = text::find_named(message.objects, watched().name);
    seen_ = object ? std::make_optional(*object) : std::nullopt;
    if (session_.phase() != SessionPhase::running) return;
    const std::optional<Observation> seen = observed(message);
    at_start_ |= seen && starts(*seen);
    if (!seen || !at_start_) return;
    session_.update(*seen);
    since_ = {};
    if (session_.phase() != SessionPhase::running) note_end();
    if (!session_.trial().events().empty()) publish();  // the state may last for less than a period
  }

  const ObjectModel& model() const { return scene_.model(session_.object().name); }

  /// True if the object is at the trial's start; messages sent before it was placed show it elsewhere.
  bool starts(const Observation& seen) const {
    const Scene& scene = model().scene;
    const Body& body = scene.bodies[model().body];
    if ((seen.pose.position - body.start.position).norm() >=
        kStartTolerance + kStartDelay * body.start_twist.linear.norm())
      return false;
    if (seen.joints.size() != scene.joints.size()) return false;
    return std::all_of(seen.joints.begin(), seen.joints.end(), [&](const auto& joint) {
      const double start = scene.joints[*find_joint(scene, joint.first)].start;
      return std::abs(joint.second - start) < kStartTolerance;
    });
  }

  /// The body that the participant watches: in a device the one that the goal's joint moves.
  const Body& watched() const {
    const Scene& scene = model().scene;
    const Goal& goal = session_.task().goals[session_.trial().goal()];
    if (goal.kind != GoalKind::joint) return scene.bodies[model().body];
    return scene.bodies[scene.joints[*find_joint(scene, goal.joint)].child];
  }

  void take_event(const msg::InteractionEvent& event) {
    if (!at_start_) return;
    since_.tracking_losses += event.kind == event.HAND_LOST;
    since_.touches += event.kind == event.CONTACT_BEGIN;
    since_.put_back |= event.kind == event.OUT_OF_BOUNDS && find_body(model().scene, event.object);
  }

  /// Changes of the system during a session are allowed, but logged.
  void take_input(const msg::SimulationInput& message) {
    try {
      for (const ParameterWatch::Difference& parameter : parameters_.take(message)) {
        session_.note_parameter(parameter.name, parameter.value, parameter.as_begun, now());
        ROS_WARN("%s is %s%s", parameter.name.c_str(), parameter.value.c_str(),
                 parameter.as_begun ? " again, as the session was begun with"
                                    : ", which is not what the session was begun with: events.csv says so");
      }
    } catch (const SessionError&) {
      throw;
    } catch (const std::exception& error) {
      ROS_WARN("a change of the running system cannot be read: %s", error.what());
    }
  }

  void take_contacts(const msg::ContactArray& message) { contacts_ = message; }
  void take_joints(const sensor_msgs::JointState& message) { joints_ = message; }
  void take_hands(const msg::HandFrame& message) { log_hands(message, false); }
  void take_filtered_hands(const msg::HandFrame& message) { log_hands(message, true); }

  void log_hands(const msg::HandFrame& message, bool filtered) {
    for (const auto& hand : message.hands) {
      for (const auto& phalanx : hand.phalanges) {
        if (phalanx.finger != phalanx.INDEX || phalanx.bone != phalanx.DISTAL) continue;
        HandRow row;
        row.filtered = filtered;
        row.hand = hand.id;
        row.side = hand.side;
        row.start = from_message(phalanx.start);
        row.end = from_message(phalanx.end);
        row.radius = phalanx.radius;
        session_.log_hand(row, on_our_clock(message.header.stamp));
      }
    }
  }

  /// Converts a stamp of the machine with the hands, whose clock may differ.
  Nanoseconds on_our_clock(const ros::Time& stamp) {
    const Nanoseconds offset = now() - from_ros_time(stamp);
    if (std::abs(offset - clock_offset_) > kMinClockOffset) clock_offset_ = offset;
    return from_ros_time(stamp) + clock_offset_;
  }

  /// Observes the object and its descendants by joints; empty while it is absent.
  std::optional<Observation> observed(const msg::ObjectStateArray& message) {
    const Scene& scene = model().scene;
    Observation seen = since_;
    seen.stamp = on_our_clock(message.header.stamp);
    seen.pose = scene.bodies[model().body].start;  // of a fixture, which no message has
    std::set<std::string> parts;
    bool there = false;
    for (const Body& body : scene.bodies) {
      parts.insert(body.name);
      const auto* const object = text::find_named(message.objects, body.name);
      if (!object) continue;
      there = true;
      seen.held |= object->held != 0;
      if (body.name != session_.object().name) continue;
      seen.pose = from_message(object->pose);
      seen.twist = from_message(object->twist);
    }
    if (!there) return std::nullopt;
    for (std::size_t j = 0; j < std::min(joints_.name.size(), joints_.position.size()); ++j) {
      if (find_joint(scene, joints_.name[j])) seen.joints.emplace_back(joints_.name[j], joints_.position[j]);
    }
    add_contacts(message.header.stamp, parts, seen);
    return seen;
  }

  /// Adds the hands' contacts with the object.
  void add_contacts(const ros::Time& stamp, const std::set<std::string>& parts, Observation& seen) const {
    if (std::abs(seconds_between(contacts_.header.stamp, stamp)) > kMaxContactAge) return;
    const auto touched = [&](const msg::Contact& contact) { return parts.count(contact.object) > 0; };
    seen.touched = std::any_of(contacts_.contacts.begin(), contacts_.contacts.end(), touched);
    seen.grip_force = grip_force(contacts_, parts);
  }

  void tick() {
    if (!failed_.empty()) throw SessionError(failed_);
    if (session_.phase() != SessionPhase::finished) session_.folder().check_there();
    const ros::SteadyTime time = ros::SteadyTime::now();
    if (session_.phase() == SessionPhase::ready && !paused_ && !next_.isZero() && time >= next_) {
      const std::string wrong = begin_trial();
      if (!wrong.empty()) ROS_WARN_DELAYED_THROTTLE(10.0, "the trial cannot begin yet: %s", wrong.c_str());
      next_ = wrong.empty() ? ros::SteadyTime() : time + kRetry;
    }
    publish();
  }

  /// Returns an error, or an empty string.
  std::string begin_trial() {
    const std::string wrong = scene_.prepare(session_.object());
    if (!wrong.empty()) return wrong;
    since_ = {};
    at_start_ = false;
    session_.begin(now());
    return "";
  }

  std::string pause(bool paused) {
    const std::string wrong = scene_.pause(paused);
    if (!wrong.empty()) return wrong;
    paused_ = paused;
    session_.pause(paused, now());
    return "";
  }

  std::string skip() {
    if (session_.phase() == SessionPhase::finished) return "all trials are done; allowed: repeat";
    session_.skip(now());
    note_end();
    return "";
  }

  std::string repeat() {
    session_.repeat(now());
    note_end();
    return next();
  }

  std::string next() {
    if (paused_) return "the session is paused; allowed: pause with false, then next";
    if (session_.phase() == SessionPhase::running) return "a trial is running; allowed: pause, skip, repeat";
    if (session_.phase() == SessionPhase::finished) return "all trials are done; allowed: repeat";
    next_ = ros::SteadyTime::now();
    return "";
  }

  void note_end() {
    at_start_ = false;
    next_ = auto_next_ < 0.0 ? ros::SteadyTime() : ros::SteadyTime::now() + ros::WallDuration(auto_next_);
    const std::optional<TrialRow>& last = session_.last();
    if (last)
      ROS_INFO("trial %d, %s: %s after %.1f s, grasped %d times, dropped %d times", last->trial,
               last->object.c_str(), to_string(last->result), last->measures.completion_time,
               last->measures.attempts, last->measures.drops);
    if (session_.phase() == SessionPhase::finished)
      ROS_INFO("All trials are done. The questions: rosrun mr_hand_interaction ask_ratings %s",
               session_.folder().path().c_str());
  }

  msg::TrainingStatus status() const {
    const Task& task = session_.task();
    const Trial& trial = session_.trial();
    msg::TrainingStatus status;
    status.header.stamp = ros::Time::now();
    status.header.frame_id = fixed_frame_;
    status.phase = static_cast<std::uint8_t>(paused_ ? SessionPhase::paused : session_.phase());
    status.stage = static_cast<std::uint8_t>(trial.stage());
    status.participant = participant_;
    status.task = task.name;
    status.object = session_.object().name;
    status.trials = session_.trials();
    status.trial = std::min<std::size_t>(session_.position() + 1, status.trials);
    status.repetition = session_.position() / task.objects.size() + (task.practice ? 0 : 1);
    status.goal = trial.goal() + 1;
    status.goals = task.goals.size();
    status.place = task.place_number(trial.goal());
    status.places = task.places();
    status.inside = trial.inside();
    status.progress = trial.progress();
    status.remaining = trial.remaining();
    status.elapsed = trial.elapsed();
    status.attempts = trial.measures().attempts;
    status.drops = trial.measures().drops;
    status.instruction = instruction_now(session_, paused_, !next_.isZero());
    if (session_.last()) status.result = to_string(session_.last()->result);
    return status;
  }

  void publish() {
    const msg::TrainingStatus message = status();
    status_.publish(message);
    if (markers_.getNumSubscribers() > 0)
      markers_.publish(training_markers(session_, watched(), message, seen_));
  }

  void publish(const EventRow& row) const {
    msg::TrainingEvent event;
    event.header.stamp = to_ros_time(row.stamp);
    event.utc = row.utc;
    event.time = row.time;
    event.trial = row.trial;
    event.stage = to_string(row.stage);
    event.event = row.event;
    event.object = row.object;
    event.detail = row.detail;
    event_.publish(event);
  }

  ros::Publisher event_;  ///< constructed before the session, which publishes events from its start
  Session session_;
  TrainingScene scene_;
  ParameterWatch parameters_;
  std::string participant_, fixed_frame_ = "world";
  double auto_next_;
  ros::SteadyTime next_;  ///< time at which the next trial starts automatically; zero: on request
  std::string failed_;    ///< reason why the session cannot continue
  bool paused_ = false;
  bool at_start_ = false;  ///< the running trial's object has been seen at its start

  Nanoseconds clock_offset_ = 0;  ///< this machine's clock minus that of the hands' stamps
  msg::ContactArray contacts_;
  sensor_msgs::JointState joints_;
  std::optional<msg::ObjectState> seen_;  ///< state of the watched body, if present
  Observation since_;                     ///< events since the last observation, and the operator now

  ros::Publisher status_, markers_;
  std::vector<ros::Subscriber> subscribers_;
  std::vector<ros::ServiceServer> services_;
  ros::SteadyTimer timer_;
};

}  // namespace mrhi

int main(int argc, char** argv) {
  return mrhi::run_node<mrhi::TrainingServer, mrhi::TrainingParameters>(argc, argv, "training_node",
                                                                        mrhi::kUsage);
}
