#pragma once

#include <dynamic_reconfigure/server.h>
#include <interactive_markers/interactive_marker_server.h>
#include <mr_hand_interaction/TuneConfig.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "mr_hand_interaction/simulation.h"

namespace mrhi {
/// Service calls that take long run in a thread of their own, beside the frames. What such a call does to the
/// simulation it hands to run(), which has it done between two frames by the thread that spins the node.
class BetweenFrames {
 public:
  explicit BetweenFrames(const ros::NodeHandle& node);
  /// Drops what waits; who waits for it gets an exception.
  ~BetweenFrames();
  BetweenFrames(const BetweenFrames&) = delete;
  BetweenFrames& operator=(const BetweenFrames&) = delete;

  /// A node handle whose services run beside the frames, after start().
  ros::NodeHandle node_beside(const ros::NodeHandle& node);
  void start() { spinner_.start(); }
  /// Blocks until `task` is done. Rethrows what it throws; throws std::runtime_error if the node ends before.
  void run(const std::function<void()>& task);

 private:
  std::uint64_t id() const { return reinterpret_cast<std::uintptr_t>(this); }

  ros::NodeHandle node_;
  std::mutex ending_mutex_;
  bool ends_ = false;
  ros::CallbackQueue beside_;
  ros::AsyncSpinner spinner_{1, &beside_};
};

/// Interactive markers by which a free object is moved with the mouse in rviz, at ~place. Feedback comes by
/// the node's own queue of callbacks; what is dragged is asked for.
class Placing {
 public:
  Placing(const ros::NodeHandle& private_node, const std::string& fixed_frame);

  void turn(bool on, const Simulation& simulation);
  /// The bodies that there are have changed.
  void renew(const Simulation& simulation);
  /// Markers follow their bodies.
  void follow(const Simulation& simulation);
  /// Where the mouse holds objects. One that was let go, or of which nothing has been heard for a second, is
  /// no longer in it.
  std::map<std::string, Pose> dragged();

 private:
  struct Drag {
    Pose pose;
    ros::WallTime heard;
  };
  void take(const visualization_msgs::InteractiveMarkerFeedback& feedback);

  std::string topic_, fixed_frame_;
  std::unique_ptr<interactive_markers::InteractiveMarkerServer> server_;
  std::map<std::string, Drag> drags_;
};

/// Ends of the sliders of all numbers, from the parameters' table. A value beyond them, but within the
/// parameter's limits, may be set all the same.
void slider_ends(mr_hand_interaction::TuneConfig& least, mr_hand_interaction::TuneConfig& most);

/// dynamic_reconfigure at ~tune: what one tunes by eye. It leaves checking to the node, so that a bad value
/// is refused instead of moved to the nearest one allowed.
class Tuning {
 public:
  using Values = std::vector<std::pair<std::string, std::string>>;  ///< names and YAML, as of parameters.h
  struct Actions {
    std::function<void(const Values&)> set;         ///< all or none; throws std::exception
    std::function<void(bool)> place_by_mouse;       ///< interactive markers on or off
    std::function<const Simulation&()> simulation;  ///< that of now
  };

  Tuning(const ros::NodeHandle& private_node, bool place_by_mouse, Actions actions);
  ~Tuning();

  /// Tells those who look what holds now, soon: each number is a call to the master, and frames do not wait
  /// for them.
  void show();

 private:
  using Config = mr_hand_interaction::TuneConfig;
  void take(Config& wanted);
  Config current() const;
  Values changes(const Config& wanted) const;
  void tell();

  Actions actions_;
  bool place_by_mouse_;
  Config shown_;
  boost::recursive_mutex mutex_;
  dynamic_reconfigure::Server<Config> server_;

  std::mutex asking_;
  std::condition_variable asked_;
  std::optional<Config> to_tell_;
  bool ends_ = false;
  std::thread teller_;
};

}  // namespace mrhi
