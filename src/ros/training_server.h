#pragma once

#include <mr_hand_interaction/ContactArray.h>
#include <mr_hand_interaction/HandFrame.h>
#include <mr_hand_interaction/InteractionEvent.h>
#include <mr_hand_interaction/ObjectStateArray.h>
#include <mr_hand_interaction/TrainingEvent.h>
#include <mr_hand_interaction/TrainingStatus.h>
#include <ros/node_handle.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "mr_hand_interaction/training/session.h"
#include "parameter_watch.h"
#include "training_scene.h"

namespace mrhi {

/// What the training node is told on the parameter server.
struct TrainingParameters {
  std::string task = "pick_and_place";  ///< ~task: name or YAML file
  SessionHeader header;       ///< ~participant, ~group, ~handedness, ~condition, ~seed, ~session, ~simulated
  std::optional<int> number;  ///< ~number: of the participant, from 1; else the one that ends the name
  std::string folder;         ///< ~folder: of the session; a ~ at its beginning is the home directory
  std::string simulation = "interaction_node";  ///< ~simulation: name of the node with the objects
  double auto_next = 3.0;    ///< ~auto_next: break after a trial [s]; below 0: the next one waits for ~next
  bool auto_start = false;   ///< ~auto_start: the first trial does not wait for ~next
  bool by_operator = false;  ///< ~operator: a simulated operator does the task, which is checked
};

/// Throws ParameterError naming a parameter that is unknown, missing or not allowed.
TrainingParameters read_training_parameters(const ros::NodeHandle& private_node);

/// Runs a session with the objects of an interaction_node, and shows how far it is. One thread.
class TrainingServer {
 public:
  /// Throws SceneError for a task that cannot be loaded, std::invalid_argument for one that a simulated
  /// operator cannot do, SessionError for a folder that cannot be used.
  TrainingServer(ros::NodeHandle node, ros::NodeHandle private_node, const TrainingParameters& parameters);
  ~TrainingServer();

 private:
  void advertise_services(ros::NodeHandle& private_node);
  void take(const mr_hand_interaction::ObjectStateArray& message);
  bool starts(const Observation& seen) const;
  const Body& watched() const;
  void take_event(const mr_hand_interaction::InteractionEvent& event);
  void take_input(const mr_hand_interaction::SimulationInput& message);
  void take_hands(const mr_hand_interaction::HandFrame& message, bool filtered);
  Nanoseconds on_our_clock(const ros::Time& stamp);
  std::optional<Observation> observed(const mr_hand_interaction::ObjectStateArray& message);
  void feel(const ros::Time& stamp, const std::set<std::string>& parts, Observation& seen) const;
  void tick();

  /// Empty, or what went wrong.
  std::string begin_trial();
  std::string pause(bool paused);
  std::string skip();
  std::string repeat();
  std::string next();
  void note_end();

  mr_hand_interaction::TrainingStatus status() const;
  void publish();
  void publish(const EventRow& row) const;

  ros::Publisher event_;  ///< before the session, which has events as it begins
  Session session_;
  TrainingScene scene_;
  ParameterWatch parameters_;
  std::string participant_, fixed_frame_ = "world";
  double auto_next_;
  ros::WallTime next_;  ///< when the next trial begins by itself; zero: when told to
  std::string failed_;  ///< why the session cannot go on
  bool paused_ = false;
  bool at_start_ = false;  ///< the running trial's object has been seen where it starts

  Nanoseconds clocks_apart_ = 0;  ///< this machine's ahead of that of the hands' stamps
  mr_hand_interaction::ContactArray contacts_;
  sensor_msgs::JointState joints_;
  std::optional<mr_hand_interaction::ObjectState> seen_;  ///< what is to be looked at, if it is there
  int tracking_losses_ = 0, touches_ = 0;
  std::optional<OperatorMotion> person_;
  bool put_back_ = false;

  ros::Publisher status_, markers_;
  std::vector<ros::Subscriber> subscribers_;
  std::vector<ros::ServiceServer> services_;
  ros::WallTimer timer_;
};

}  // namespace mrhi
