#pragma once

#include <dynamic_reconfigure/server.h>
#include <mr_hand_interaction/TuneConfig.h>
#include <ros/ros.h>

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "mr_hand_interaction/simulation.h"

namespace mrhi {

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
