#pragma once

#include <mr_hand_interaction/HandFrame.h>
#include <mr_hand_interaction/SimulationInput.h>
#include <ros/ros.h>
#include <ros/time.h>

#include <functional>
#include <string>

#include "../record/record.h"
#include "mr_hand_interaction/math.h"

namespace mrhi {
/// Time of the hand stream between and beyond its frames: the last stamp, and what has passed since it
/// arrived. So stamps may come from another clock, as those of a bag do. The simulation's time is that
/// without pauses.
class StampClock {
 public:
  /// A frame with this stamp has arrived.
  void take(Nanoseconds stamp, const ros::Time& now);
  /// Stamp that a frame of now would have; now itself before the first frame. Does not go back if ROS time
  /// does.
  Nanoseconds stamp(const ros::Time& now) const;

  void pause(const ros::Time& now);
  void resume(const ros::Time& now);
  bool paused() const { return paused_; }

  Nanoseconds to_simulation(Nanoseconds stamp) const { return stamp - pauses_; }
  Nanoseconds to_stamp(Nanoseconds simulation_time) const { return simulation_time + pauses_; }

 private:
  bool started_ = false;
  Nanoseconds last_stamp_ = 0;
  ros::Time arrival_;
  bool paused_ = false;
  Nanoseconds pause_begin_ = 0;
  Nanoseconds pauses_ = 0;
};

/// Whether ROS's clock leaps ahead from one look at it to the next. It is believed once it is still there:
/// /clock may be of another time for a moment, and a scene that had gone there with it would be at its start
/// when it is back.
class ClockLeaps {
 public:
  bool look(Nanoseconds now);

 private:
  Nanoseconds looked_ = 0, stride_ = 0;  // when, and what had passed since the look before
};

/// Publishes `simulation_input`: all that a simulation is given, in its order, after it has taken it. Who
/// begins to listen is sent first what the simulation is then. Costs next to nothing while nobody listens.
class InputLog {
 public:
  InputLog(ros::NodeHandle& node, World world, const LiveSimulation& simulation, const StampClock& clock);

  /// `time`, `expected`: as Simulation::begin got them.
  void frame(const mr_hand_interaction::HandFrame& hands, Nanoseconds time, Nanoseconds expected);
  void without_hands(Nanoseconds time);
  void change(const Change& change);
  void lost(std::uint64_t frames) { lost_ = frames; }

  std::uint64_t sequence() const { return sequence_; }

 private:
  void send_begin(const ros::SingleSubscriberPublisher& subscriber);
  mr_hand_interaction::SimulationInput message(std::uint8_t kind) const;
  bool heard() const { return publisher_.getNumSubscribers() > 0; }

  World world_;
  const LiveSimulation& simulation_;
  const StampClock& clock_;
  std::uint64_t run_, sequence_ = 0, lost_ = 0;
  ros::Publisher publisher_;
};

}  // namespace mrhi
